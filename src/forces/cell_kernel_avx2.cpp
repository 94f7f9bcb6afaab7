#include "forces/cell_kernel.h"

#include "base/polar.h"

#if defined(__x86_64__)

PHYXEL_BEGIN_TARGET(PHYXEL_AVX2_FMA)

#include "forces/cell_kernel_body.h"

namespace phyxel {

double cell_kernel_avx2(std::span<const CellChunk> chunks, CellTask task, const CellSlots& slots) {
    return CellKernelBody<Avx2Lanes>::run(chunks, task, slots);
}

}  // namespace phyxel

PHYXEL_END_TARGET

#endif
