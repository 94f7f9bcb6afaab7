#include "reference/fem/solve.h"

#include <utility>

namespace phyxel::fem {

StaticResult solve_static(const Solid& solid, const Conditions& conditions, const NewtonSettings& settings) {
    return solve_static(solid, conditions, solid.mesh.X, settings);
}

StaticResult solve_static(const Solid& solid, const Conditions& conditions, std::vector<Vec3> start,
                          const NewtonSettings& settings) {
    System system(solid, conditions);
    std::vector<Vec3> x = std::move(start);
    const NewtonReport report = minimize(system, {}, x, settings);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= solid.mesh.X[i];
    return {std::move(x), report.iterations, report.converged, report.residual};
}

State at_rest(const Solid& solid) { return {solid.mesh.X, std::vector<Vec3>(solid.mesh.X.size())}; }

NewtonReport step_implicit_euler(System& system, State& state, double dt, double damping,
                                 const NewtonSettings& settings) {
    // With v' = (x' - x)/dt both terms with M are c M (x' - y), c = (1/dt + damping)/dt, y = x + v/(dt c).
    Inertia inertia{.c = (1 / dt + damping) / dt, .y = state.x};
    for (std::size_t i = 0; i < inertia.y.size(); ++i) inertia.y[i] += 1 / (dt * inertia.c) * state.v[i];

    // From where it was; y, where it would be without forces, may be far from equilibrium.
    std::vector<Vec3> x = state.x;
    const NewtonReport report = minimize(system, inertia, x, settings);
    if (!report.converged) return report;
    for (std::size_t i = 0; i < x.size(); ++i) state.v[i] = 1 / dt * (x[i] - state.x[i]);
    state.x = std::move(x);
    return report;
}

double kinetic_energy(const System& system, const State& state) {
    const Eigen::VectorXd v = system.gather(state.v);
    const Eigen::VectorXd momentum = system.mass().selfadjointView<Eigen::Lower>() * v;
    return 0.5 * v.dot(momentum);
}

}  // namespace phyxel::fem
