#pragma once

#include "solver/newton.h"

namespace phyxel {

enum class ImplicitScheme { euler, bdf2 };

/// One implicit step of a body from `start` over `dt` [s], as the minimization of an incremental potential: backward
/// Euler, or the second order backward difference formula with variable steps (Hairer and Wanner, Solving Ordinary
/// Differential Equations II, section III.5), whose first step is backward Euler's. (Brunet et al. 2019 take one Newton
/// iteration of the former from where the body was; on a falling beam that misses the step by up to a quarter of its
/// length.) On failure the body is where it was.
SolveReport implicit_step(DynamicBody& body, const Surroundings& around, ImplicitScheme scheme, double start, double dt,
                          const Threads& threads);

}  // namespace phyxel
