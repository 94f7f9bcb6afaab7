#pragma once

#include "solver/newton.h"

namespace phyxel {

/// Brings a body to equilibrium with the loads and grips of `end` [s], from where it is with those of `start`: Newton's
/// method with the exact tangent to 1e-9 of the forces, in one load step where that converges, else in as many as are
/// needed; each is tried with whole steps first, then with guarded ones. Velocities become zero. On failure
/// `converged` is false, `trouble` says what happened, and the body is where it was.
SolveReport find_equilibrium(DynamicBody& body, const Surroundings& around, double start, double end,
                             const Threads& threads);

}  // namespace phyxel
