#pragma once

#include "material/lame.h"
#include "phyxel/vector.h"

/// Hooke's law with small strain eps = (F + F^T)/2 - I, which is right for small rotations only: a body turned by 90
/// degrees looks stretched to it. For comparison (Brunet et al. 2019, figure 2).
///     Psi = mu eps:eps + lambda/2 tr(eps)^2,  P = 2 mu eps + lambda tr(eps) I
/// Test: tests/material/law_test.cpp.

namespace phyxel {

namespace linear_detail {

inline Mat3 hooke(const Mat3& H, const Lame& m) {
    return m.mu * (H + transpose(H)) + m.lambda * trace(H) * Mat3::identity();
}

}  // namespace linear_detail

/// Energy density [J/m^3].
inline double linear_energy(const Mat3& F, const Lame& m) {
    const Mat3 H = F - Mat3::identity();
    return 0.5 * contract(H, linear_detail::hooke(H, m));
}

/// First Piola-Kirchhoff stress [Pa], the derivative of the energy by F.
inline Mat3 linear_stress(const Mat3& F, const Lame& m) { return linear_detail::hooke(F - Mat3::identity(), m); }

/// Change of the stress with F by dF [Pa].
inline Mat3 linear_stress_action(const Mat3&, const Mat3& dF, const Lame& m) { return linear_detail::hooke(dF, m); }

/// Dilatation tr(eps), of which the energy holds lambda/2 times the square; its derivative by F is I.
inline double linear_dilatation(const Mat3& F) { return trace(F - Mat3::identity()); }

}  // namespace phyxel
