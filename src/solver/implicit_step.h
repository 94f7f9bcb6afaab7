#pragma once

#include "solver/newton.h"

namespace phyxel {

enum class ImplicitScheme { euler, bdf2 };

/// One implicit step of bodies that may touch each other, found together, from `start` over `dt` [s], as the
/// minimization of an incremental potential: backward Euler, or the second order backward difference formula with
/// variable steps (Hairer and Wanner, Solving Ordinary Differential Equations II, section III.5), whose first step is
/// backward Euler's. (Brunet et al. 2019 take one Newton iteration of the former from where the body was; on a falling
/// beam that misses the step by up to a quarter of its length.) `members` are the numbers of the bodies among `all`. On
/// failure they are where they were.
SolveReport implicit_step(std::span<const std::unique_ptr<DynamicBody>> all, std::span<const std::uint32_t> members,
                          const Surroundings& around, ImplicitScheme scheme, double start, double dt,
                          const Threads& threads);

/// The bodies that may touch each other within a step of `dt` [s] that ends at `end`, group by group; one that meets no
/// other is a group by itself.
std::vector<std::vector<std::uint32_t>> groups_that_may_touch(std::span<const std::unique_ptr<DynamicBody>> all,
                                                              const Surroundings& around, double end, double dt);

}  // namespace phyxel
