#pragma once

#include "material/cofactor.h"
#include "material/lame.h"
#include "phyxel/vector.h"

/// Hooke's law with Green strain E = (F^T F - I)/2, and optionally a penalty k_v on change of volume.
///     Psi = mu E:E + lambda/2 tr(E)^2 + k_v/2 (J - 1)^2,  P = F S + k_v (J - 1) cof F,  S = 2 mu E + lambda tr(E) I
/// Source: Stegmayr 2008, 3.34 to 3.43 and 3.60 to 3.62. Deviations: strain and its derivative both carry the half (as
/// printed in listing 4.1.1 the force is twice the derivative of the energy); the order is F S (printed: sigma J,
/// another force as soon as the body turns). The law softens under compression and collapses where a principal
/// stretch falls below 1/sqrt(3). Test: tests/material/law_test.cpp.

namespace phyxel {

namespace saint_venant_kirchhoff_detail {

/// Second Piola-Kirchhoff stress S [Pa] of a strain, or its change with the change of strain.
inline Mat3 hooke(const Mat3& E, const Lame& m) { return 2 * m.mu * E + m.lambda * trace(E) * Mat3::identity(); }

inline Mat3 green_strain(const Mat3& F) {
    const Vec3 a = F.column(0), b = F.column(1), c = F.column(2);
    const double ab = 0.5 * dot(a, b), ac = 0.5 * dot(a, c), bc = 0.5 * dot(b, c);
    return {{{0.5 * (dot(a, a) - 1), ab, ac}, {ab, 0.5 * (dot(b, b) - 1), bc}, {ac, bc, 0.5 * (dot(c, c) - 1)}}};
}

}  // namespace saint_venant_kirchhoff_detail

/// Energy density [J/m^3].
inline double saint_venant_kirchhoff_energy(const Mat3& F, const Lame& m, double volume_stiffness = 0) {
    using namespace saint_venant_kirchhoff_detail;
    const Mat3 E = green_strain(F);
    const double growth = determinant(F) - 1;
    return 0.5 * contract(E, hooke(E, m)) + 0.5 * volume_stiffness * growth * growth;
}

/// First Piola-Kirchhoff stress [Pa], the derivative of the energy by F.
inline Mat3 saint_venant_kirchhoff_stress(const Mat3& F, const Lame& m, double volume_stiffness = 0) {
    using namespace saint_venant_kirchhoff_detail;
    const Mat3 P = F * hooke(green_strain(F), m);
    if (volume_stiffness == 0) return P;
    return P + volume_stiffness * (determinant(F) - 1) * cofactor(F);
}

/// Change of the stress with F by dF [Pa].
inline Mat3 saint_venant_kirchhoff_stress_action(const Mat3& F, const Mat3& dF, const Lame& m,
                                                 double volume_stiffness = 0) {
    using namespace saint_venant_kirchhoff_detail;
    const Mat3 FtdF = transpose(F) * dF;
    const Mat3 dE = 0.5 * (FtdF + transpose(FtdF));
    const Mat3 dP = dF * hooke(green_strain(F), m) + F * hooke(dE, m);
    if (volume_stiffness == 0) return dP;
    const Mat3 cof = cofactor(F);
    const double J = dot(F.rows[0], cof.rows[0]);
    return dP + volume_stiffness * (contract(cof, dF) * cof + (J - 1) * cofactor_action(F, dF));
}

/// Dilatation tr(E), of which the energy holds lambda/2 times the square; its derivative by F is F.
inline double saint_venant_kirchhoff_dilatation(const Mat3& F) {
    return trace(saint_venant_kirchhoff_detail::green_strain(F));
}

}  // namespace phyxel
