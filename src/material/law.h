#pragma once

#include "material/corotated.h"
#include "material/lame.h"
#include "material/linear.h"
#include "material/neo_hookean.h"
#include "material/saint_venant_kirchhoff.h"
#include "material/stress_measures.h"

/// The closed set of laws behind one switch, for the loops over quadrature points.

namespace phyxel {

/// What a quadrature point needs to know of its material.
struct MaterialPoint {
    Law law = Law::neo_hookean;
    Lame lame;                    ///< [Pa]
    double volume_stiffness = 0;  ///< k_v [Pa], Saint Venant-Kirchhoff only
};

inline MaterialPoint material_point(const Material& material) {
    return {.law = material.law, .lame = lame(material), .volume_stiffness = material.volume_stiffness};
}

/// Energy density [J/m^3] at deformation gradient F.
inline double energy(const MaterialPoint& m, const Mat3& F) {
    switch (m.law) {
        case Law::linear:
            return linear_energy(F, m.lame);
        case Law::saint_venant_kirchhoff:
            return saint_venant_kirchhoff_energy(F, m.lame, m.volume_stiffness);
        case Law::corotated:
            return corotated_energy(F, m.lame);
        case Law::neo_hookean:
            break;
    }
    return neo_hookean_energy(F, m.lame);
}

/// First Piola-Kirchhoff stress P [Pa] at deformation gradient F: force per rest area, P = dPsi/dF.
inline Mat3 stress(const MaterialPoint& m, const Mat3& F) {
    switch (m.law) {
        case Law::linear:
            return linear_stress(F, m.lame);
        case Law::saint_venant_kirchhoff:
            return saint_venant_kirchhoff_stress(F, m.lame, m.volume_stiffness);
        case Law::corotated:
            return corotated_stress(F, m.lame);
        case Law::neo_hookean:
            break;
    }
    return neo_hookean_stress(F, m.lame);
}

/// Change dP [Pa] of the stress when F changes by dF: the second derivative of the energy, applied to dF; symmetric.
inline Mat3 stress_action(const MaterialPoint& m, const Mat3& F, const Mat3& dF) {
    switch (m.law) {
        case Law::linear:
            return linear_stress_action(F, dF, m.lame);
        case Law::saint_venant_kirchhoff:
            return saint_venant_kirchhoff_stress_action(F, dF, m.lame, m.volume_stiffness);
        case Law::corotated:
            return corotated_stress_action(F, dF, m.lame);
        case Law::neo_hookean:
            break;
    }
    return neo_hookean_stress_action(F, dF, m.lame);
}

/// Every law's energy is that of lambda = 0 and lambda/2 theta^2, theta its own measure of the change of volume. (Of
/// stable neo-Hookean's (lambda + mu)/2 (J - 1)^2 the part with mu stays with the point: without it the rest would have
/// negative energy where neighbours swell and shrink in turn.)
inline MaterialPoint without_dilatation(MaterialPoint m) { return m.lame.lambda = 0, m; }

/// Dilatation theta(F); zero at rest.
inline double dilatation(Law law, const Mat3& F) {
    switch (law) {
        case Law::linear:
            return linear_dilatation(F);
        case Law::saint_venant_kirchhoff:
            return saint_venant_kirchhoff_dilatation(F);
        case Law::corotated:
            return corotated_dilatation(F);
        case Law::neo_hookean:
            break;
    }
    return neo_hookean_dilatation(F);
}

/// dtheta/dF: p times it is the stress of a pressure -p.
inline Mat3 dilatation_gradient(Law law, const Mat3& F) {
    switch (law) {
        case Law::linear:
            return Mat3::identity();
        case Law::saint_venant_kirchhoff:
            return F;
        case Law::corotated:
            return polar_rotation(F);
        case Law::neo_hookean:
            break;
    }
    return cofactor(F);
}

/// Change of dtheta/dF with F by dF; symmetric.
inline Mat3 dilatation_gradient_action(Law law, const Mat3& F, const Mat3& dF) {
    switch (law) {
        case Law::linear:
            return {};
        case Law::saint_venant_kirchhoff:
            return dF;
        case Law::corotated:
            return corotated_rotation_action(F, dF);
        case Law::neo_hookean:
            break;
    }
    return cofactor_action(F, dF);
}

}  // namespace phyxel
