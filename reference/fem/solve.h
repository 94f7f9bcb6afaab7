#pragma once

#include <vector>

#include "phyxel/vector.h"
#include "reference/fem/newton.h"
#include "reference/fem/solid.h"
#include "reference/fem/system.h"

/// Statics and dynamics of a finite element solid.

namespace phyxel::fem {

struct StaticResult {
    std::vector<Vec3> displacement;  ///< [nodes] [m]; a solution only if converged
    int iterations = 0;              ///< linear solves
    bool converged = false;          ///< to a stable equilibrium
    double residual = 0;             ///< relative to the forces that balance
};

/// Equilibrium under the conditions, starting at rest, or at positions `start` [nodes], whose fixed coordinates stay.
StaticResult solve_static(const Solid& solid, const Conditions& conditions, const NewtonSettings& settings = {});
StaticResult solve_static(const Solid& solid, const Conditions& conditions, std::vector<Vec3> start,
                          const NewtonSettings& settings = {});

/// What moves.
struct State {
    std::vector<Vec3> x;  ///< [nodes] positions [m]
    std::vector<Vec3> v;  ///< [nodes] velocities [m/s]
};

State at_rest(const Solid& solid);

/// One step of the nonlinear implicit Euler method with mass-proportional damping `damping` [1/s]:
///     M (v' - v)/dt + damping M v' = f_ext + f_elastic(x'),  x' = x + dt v'
/// (Brunet et al. 2019, equation 15, solved to the tolerance in place of the one linearized step of equation 16.)
/// Unconverged, the state is left as it was.
NewtonReport step_implicit_euler(System& system, State& state, double dt, double damping = 0,
                                 const NewtonSettings& settings = {});

/// Kinetic energy of the free coordinates [J].
double kinetic_energy(const System& system, const State& state);

}  // namespace phyxel::fem
