#pragma once

#include <vector>

#include "phyxel/vector.h"
#include "reference/fem/system.h"

/// Newton's method for equilibrium and for one implicit step: both look for a minimum over the free coordinates of
///     U(x) - f . x + c/2 |x - y|_M^2
/// with elastic energy U, dead forces f, consistent mass M; c = 0 in statics.

namespace phyxel::fem {

struct NewtonSettings {
    double tolerance = 1e-9;  ///< residual force, relative to the forces that balance
    int max_iterations = 60;  ///< linear solves
};

struct NewtonReport {
    int iterations = 0;      ///< linear solves, those of failed attempts included
    bool converged = false;  ///< residual within tolerance, and the tangent there positive definite: a stable state
    double residual = 0;     ///< relative to the forces that balance
    bool searched = false;   ///< full steps alone did not do
};

/// The pull of inertia: c [1/s^2] and y [nodes].
struct Inertia {
    double c = 0;
    std::vector<Vec3> y;
};

/// Moves the free coordinates of x to the minimum. Full steps with the exact tangent; where they diverge or end in an
/// unstable state, ten steps along definite tangents, each searched for a decrease of the potential, and full steps
/// again from there. x is what was reached: look at `converged` before using it.
NewtonReport minimize(System& system, const Inertia& inertia, std::vector<Vec3>& x, const NewtonSettings& settings);

}  // namespace phyxel::fem
