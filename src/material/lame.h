#pragma once

#include <cmath>

#include "phyxel/material.h"

namespace phyxel {

/// Lamé's moduli [Pa]: the small-strain stress of every law is 2 mu eps + lambda tr(eps) I.
struct Lame {
    double lambda = 0;
    double mu = 0;
};

inline Lame lame(const Material& material) {
    const double E = material.youngs_modulus, nu = material.poissons_ratio;
    return {.lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), .mu = E / (2 * (1 + nu))};
}

/// Modulus of plane pressure waves, lambda + 2 mu [Pa].
inline double p_wave_modulus(const Lame& m) { return m.lambda + 2 * m.mu; }

/// Bulk modulus lambda + 2 mu / 3 [Pa].
inline double bulk_modulus(const Lame& m) { return m.lambda + 2 * m.mu / 3; }

/// Speed of pressure waves c_p = sqrt((lambda + 2 mu) / rho) [m/s]: the speed that limits an explicit step.
/// (Stegmayr 2008, 3.57 has sqrt(E / rho), the speed in a thin rod, which is lower.)
inline double pressure_wave_speed(const Lame& m, double density) { return std::sqrt(p_wave_modulus(m) / density); }

/// Speed of shear waves c_s = sqrt(mu / rho) [m/s].
inline double shear_wave_speed(const Lame& m, double density) { return std::sqrt(m.mu / density); }

}  // namespace phyxel
