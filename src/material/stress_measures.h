#pragma once

#include <algorithm>
#include <cmath>

#include "base/eigen3.h"
#include "phyxel/vector.h"

/// What one reads off a state of stress.

namespace phyxel {

/// Cauchy stress sigma = P F^T / J [Pa], force per current area. A point squeezed to no volume has none: zero there.
inline Mat3 cauchy_stress(const Mat3& F, const Mat3& P) {
    const double J = determinant(F);
    return std::abs(J) > 1e-12 ? (1 / J) * (P * transpose(F)) : Mat3{};
}

/// Von Mises stress sqrt(3/2 s:s) [Pa], s the deviator of sigma.
inline double von_mises(const Mat3& sigma) {
    const Mat3 deviator = sigma - (trace(sigma) / 3) * Mat3::identity();
    return std::sqrt(1.5 * contract(deviator, deviator));
}

/// Principal stresses [Pa], largest (most tensile) first.
inline Vec3 principal(const Mat3& sigma) {
    const Vec3 ascending = symmetric_eigen(sigma).values;
    return {ascending.z, ascending.y, ascending.x};
}

}  // namespace phyxel
