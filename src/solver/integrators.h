#pragma once

#include "solver/dynamic_body.h"

namespace phyxel {

/// Both integrators take `count` steps of `dt` [s] from time `start`, with positions and velocities of the same moment
/// at both ends, and follow the same trajectory where forces depend on positions alone. Symplectic, second order,
/// stable for dt below 2 / (largest angular frequency).
///
/// Leap-frog (Stegmayr 2008, section 3.7): velocities live at half steps, v_{n+1/2} = v_{n-1/2} + dt f(x_n)/m,
/// x_{n+1} = x_n + dt v_{n+1/2}; a run begins and ends with half a kick. The thesis' listing divides by the mass twice.
void leap_frog(DynamicBody& body, const Surroundings& around, double start, double dt, std::size_t count,
               const Threads& threads);

/// Velocity Verlet: half a kick before and after every drift (Stegmayr 2008, 3.54 with the force at the end of the
/// step).
void verlet(DynamicBody& body, const Surroundings& around, double start, double dt, std::size_t count,
            const Threads& threads);

}  // namespace phyxel
