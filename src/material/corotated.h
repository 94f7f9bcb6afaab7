#pragma once

#include "base/eigen3.h"
#include "base/polar.h"
#include "material/lame.h"
#include "phyxel/vector.h"

/// Corotated linear law: Hooke's law in the frame turned with the material, F = R S, det R = +1 also where F inverts.
///     Psi = mu |F - R|^2 + lambda/2 tr(S - I)^2,  P = 2 mu (F - R) + lambda tr(S - I) R
///     dP  = 2 mu dF + lambda (R : dF) R + (lambda tr(S - I) - 2 mu) dR
///     dR  = R [omega]x,  (tr(S) I - S) omega = axl(R^T dF - dF^T R),  axl(W) = (W32, W13, W21)
/// Source: Brunet et al. 2019, section 2. Deviations: R is the rotation of F itself (their equation 11 takes that of F
/// times the neighbourhood's moment, which sees rotation in pure stretch and has no energy); the change of R is kept
/// (without it the tangent misses the geometric stiffness). Test: tests/material/law_test.cpp.

namespace phyxel {

namespace corotated_detail {

/// omega for a change dF. Where two stretches sum to nearly zero the rotation is no function of F: no turning there.
inline Vec3 rotation_rate(const Mat3& R, const Mat3& F, const Mat3& dF) {
    const Mat3 W = transpose(R) * dF;
    const Vec3 axial = {W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)};
    const Mat3 RtF = transpose(R) * F;
    const Mat3 S = 0.5 * (RtF + transpose(RtF));
    const Mat3 D = trace(S) * Mat3::identity() - S;

    // Eigenvalues of D are the sums of two stretches; cofactors suffice while they are of one size.
    const double size = trace(D);
    if (determinant(D) > 1e-4 * size * size * size && size > 1e-6) return inverse(D) * axial;
    const SymmetricEigen3 eigen = symmetric_eigen(D);
    Vec3 omega;
    for (std::size_t k = 0; k < 3; ++k)
        if (eigen.values[k] > 1e-8)
            omega += dot(eigen.vectors.column(k), axial) / eigen.values[k] * eigen.vectors.column(k);
    return omega;
}

/// Change of R with F by dF.
inline Mat3 rotation_change(const Mat3& R, const Mat3& F, const Mat3& dF) {
    const Vec3 w = rotation_rate(R, F, dF);
    return R * Mat3{{{0, -w.z, w.y}, {w.z, 0, -w.x}, {-w.y, w.x, 0}}};
}

}  // namespace corotated_detail

/// Energy density [J/m^3].
inline double corotated_energy(const Mat3& F, const Lame& m) {
    const Mat3 R = polar_rotation(F);
    const Mat3 stretch = F - R;
    const double growth = contract(R, stretch);
    return m.mu * contract(stretch, stretch) + 0.5 * m.lambda * growth * growth;
}

/// First Piola-Kirchhoff stress [Pa], the exact derivative of the energy by F, although R varies with F.
inline Mat3 corotated_stress(const Mat3& F, const Lame& m) {
    const Mat3 R = polar_rotation(F);
    const Mat3 stretch = F - R;
    return 2 * m.mu * stretch + m.lambda * contract(R, stretch) * R;
}

/// Change of the stress with F by dF [Pa].
inline Mat3 corotated_stress_action(const Mat3& F, const Mat3& dF, const Lame& m) {
    const Mat3 R = polar_rotation(F);
    const Mat3 dR = corotated_detail::rotation_change(R, F, dF);
    const double pressure = m.lambda * contract(R, F - R);
    return 2 * m.mu * dF + m.lambda * contract(R, dF) * R + (pressure - 2 * m.mu) * dR;
}

/// The same without the change of R: never negative, and blind to the stiffness that stress gives (Brunet et al. 2019,
/// equation 14, corrected).
inline Mat3 corotated_frozen_action(const Mat3& F, const Mat3& dF, const Lame& m) {
    const Mat3 R = polar_rotation(F);
    const Mat3 W = transpose(R) * dF;
    return R * (m.mu * (W + transpose(W)) + m.lambda * trace(W) * Mat3::identity());
}

/// Dilatation tr(S - I), of which the energy holds lambda/2 times the square; its derivative by F is R.
inline double corotated_dilatation(const Mat3& F) {
    const Mat3 R = polar_rotation(F);
    return contract(R, F - R);
}

/// Change of R with F by dF.
inline Mat3 corotated_rotation_action(const Mat3& F, const Mat3& dF) {
    return corotated_detail::rotation_change(polar_rotation(F), F, dF);
}

}  // namespace phyxel
