#pragma once

#include <string>

#include "solver/coupled_bodies.h"

namespace phyxel {

/// How a nonlinear solve went.
struct SolveReport {
    bool converged = false;
    std::size_t newton_iterations = 0;  ///< Newton's, or L-BFGS's
    std::size_t linear_iterations = 0;  ///< of conjugate gradients, all together
    std::size_t linear_worst = 0;       ///< in one Newton iteration
    double residual = 0;                ///< norm of the gradient at the end [N]
    std::string trouble{};              ///< why it did not converge

    void add(const SolveReport& other);
};

/// When a solve is done: either bound suffices.
struct SolveTolerance {
    double force = 0;   ///< |g| [N]
    double energy = 0;  ///< sqrt(g . V g) over the way of each body, V the preconditioner: a distance to the solution
    double linear = 1e-5;  ///< share of the linear systems' error, in the norm of the tangent, that may be left
};

enum class NewtonSteps {
    full,     ///< always the whole step: fastest where it converges, and told at once where it does not
    guarded,  ///< shortened where it overshoots; negative curvature ends the conjugate gradients
};

/// Newton's method with the exact tangent and preconditioned conjugate gradients (Nocedal and Wright, Numerical
/// Optimization, algorithm 7.1). Held components of `x` that are not in place yet are brought there by the first
/// iteration, together with the response of the rest. Gives up when the residual is a thousand times what the first
/// iteration left, has grown three times in a row, or after `most` iterations; `x` is then whatever was reached.
SolveReport newton(CoupledBodies& bodies, std::vector<Vec3>& x, const SolveTolerance& tolerance, NewtonSteps steps,
                   int most);

/// L-BFGS (Nocedal and Wright, algorithm 7.4) with the preconditioner as first inverse Hessian and five pairs, kept
/// within the solve: one gradient and one preconditioner application an iteration. Full steps, shortened by the secant
/// rule until they do not overshoot. The preconditioner stays as it was turned. Gives up after `most` iterations or
/// three shortened steps in a row.
SolveReport l_bfgs(CoupledBodies& bodies, std::vector<Vec3>& x, const SolveTolerance& tolerance, int most);

}  // namespace phyxel
