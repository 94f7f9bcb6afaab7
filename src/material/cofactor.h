#pragma once

#include "phyxel/vector.h"

namespace phyxel {

/// Change of the cofactor matrix with F by dF: the second derivative of the determinant, applied to dF.
inline Mat3 cofactor_action(const Mat3& F, const Mat3& dF) {
    const auto change = [&](int a, int b) { return cross(dF.rows[a], F.rows[b]) + cross(F.rows[a], dF.rows[b]); };
    return {{change(1, 2), change(2, 0), change(0, 1)}};
}

}  // namespace phyxel
