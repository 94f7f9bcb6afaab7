#pragma once

namespace phyxel {

/// How an implicit step is found. Static equilibria are always found by Newton's method.
enum class SolverMethod {
    l_bfgs,         ///< L-BFGS with a warped multigrid preconditioner, Newton's method behind it; default
    newton,         ///< Newton's method with conjugate gradients, shortened where it overshoots
    single_newton,  ///< one Newton iteration from where the body was, as Brunet et al. 2019 take: for comparison only,
                    ///< it misses the step by far where a body turns fast
};

/// What Newton's method takes for the second derivative of the energy.
enum class Tangent {
    exact,
    brunet_2019,  ///< of the corotated law without the change of rotation (Brunet et al. 2019, equation 14, corrected):
                  ///< converges linearly in bending and not at all in stretching, which is told
};

/// Of the internal forces while an implicit step is looked for.
enum class SolverPrecision {
    single,  ///< default: two to three times as fast; tolerances below 1e-5, where its rounding would be felt, take
             ///< `full`
    full,
};

inline constexpr double default_step_tolerance = 3e-3, default_static_tolerance = 1e-9;

struct SolverSettings {
    SolverMethod method = SolverMethod::l_bfgs;
    double tolerance = 0;  ///< of an implicit step: distance from the solution over the way of the free step, in the
                           ///< metric of the masses; of an equilibrium: residual over the forces that act. 0 to 0.5;
                           ///< 0: the defaults above
    Tangent tangent = Tangent::exact;
    SolverPrecision precision = SolverPrecision::single;
};

}  // namespace phyxel
