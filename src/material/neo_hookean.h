#pragma once

#include "material/cofactor.h"
#include "material/lame.h"
#include "phyxel/vector.h"

/// Stable neo-Hookean law: finite at J = 0 and beyond, so that an inverted point finds its way back.
///     Psi = mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2
///     P   = mu (F - cof F) + (lambda + mu) (J - 1) cof F
/// Psi and P vanish at F = I, where the tangent is Hooke's with the same lambda and mu. This is the polynomial
/// neo-Hookean law of Smith, de Goes and Kim, "Stable Neo-Hookean Flesh Simulation", ACM Trans. Graph. 37 (2018), 12,
/// equation 11, without their logarithmic term and with its moduli shifted to those of Hooke. It stands in for the
/// Mooney-Rivlin law of Stegmayr 2008, appendix A.2. Test: tests/material/law_test.cpp.

namespace phyxel {

/// Energy density [J/m^3].
inline double neo_hookean_energy(const Mat3& F, const Lame& m) {
    // |F|^2 - 3 and J - 1 from H = F - I, which keeps the digits at small strain.
    const Mat3 H = F - Mat3::identity();
    const double minors = trace(cofactor(H)), det = determinant(H);
    const double growth = trace(H) + minors + det;
    return m.mu * (0.5 * contract(H, H) - minors - det) + 0.5 * (m.lambda + m.mu) * growth * growth;
}

/// First Piola-Kirchhoff stress [Pa], the derivative of the energy by F.
inline Mat3 neo_hookean_stress(const Mat3& F, const Lame& m) {
    const Mat3 cof = cofactor(F);
    const double J = dot(F.rows[0], cof.rows[0]);
    return m.mu * F + ((m.lambda + m.mu) * (J - 1) - m.mu) * cof;
}

/// Change of the stress with F by dF [Pa].
inline Mat3 neo_hookean_stress_action(const Mat3& F, const Mat3& dF, const Lame& m) {
    const Mat3 cof = cofactor(F);
    const double J = dot(F.rows[0], cof.rows[0]), bulk = m.lambda + m.mu;
    return m.mu * dF + bulk * contract(cof, dF) * cof + (bulk * (J - 1) - m.mu) * cofactor_action(F, dF);
}

/// Dilatation J - 1, of which the energy holds lambda/2 times the square; its derivative by F is cof F.
inline double neo_hookean_dilatation(const Mat3& F) {
    const Mat3 H = F - Mat3::identity();
    return trace(H) + trace(cofactor(H)) + determinant(H);
}

}  // namespace phyxel
