#include "base/polar.h"

#include "base/svd.h"

namespace phyxel {

Mat3 polar_detail::rotation_by_svd(const Mat3& F) {
    const Svd3 svd = rotation_variant_svd(F);
    return svd.U * transpose(svd.V);
}

}  // namespace phyxel
