#include "solver/implicit_step.h"

#include <algorithm>
#include <cmath>

#include "solver/nodal_vectors.h"
#include "solver/step.h"

namespace phyxel {
namespace {

constexpr double tolerance = 3e-3;  ///< of the way of a step, in the metric of the masses
constexpr double least_way = 1e-6;  ///< [spacings] of all nodes, below which nothing moves
constexpr int most_iterations = 40, most_newton = 60;
constexpr int friction_passes = 2;  ///< solves with normal forces of the last one

/// v = (a0 x - past x)/dt and f = M (a0 v - past v)/dt, past = a1 now - a2 before.
struct Difference {
    double a0 = 1, a1 = 1, a2 = 0;
};

Difference difference(const History& history, ImplicitScheme scheme, double dt) {
    if (scheme == ImplicitScheme::euler || history.dt <= 0) return {};
    const double w = dt / history.dt;
    return {(1 + 2 * w) / (1 + w), 1 + w, w * w / (1 + w)};
}

std::vector<Vec3> past(const Difference& d, std::span<const Vec3> now, std::span<const Vec3> before) {
    std::vector<Vec3> result(now.begin(), now.end());
    for (std::size_t i = 0; i < now.size(); ++i) {
        result[i] *= d.a1;
        if (d.a2 != 0) result[i] -= d.a2 * before[i];
    }
    return result;
}

/// Kinetic and stored energy [J], in the precision of the step's forces: rounding does not add up over steps.
double step_energy(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    double energy = kinetic_energy(b, threads) + b.penalty_energy;
    if (b.contact) energy += b.contact->energy(around.colliders, b.state.x, threads);
    if (b.fast_forces) return energy + b.fast_forces->energy(b.model, b.state.x, threads);
    return energy + elastic_energy(b.model, b.state.x, b.work, threads) +
           stabilization_energy(b.model, b.state.x, b.work, threads);
}

SolveReport solve(IncrementalPotential& potential, WarpedPreconditioner& preconditioner, std::vector<Vec3>& x,
                  const SolveTolerance& bound) {
    SolveReport report = l_bfgs(potential, preconditioner, x, bound, most_iterations);
    if (report.converged) return report;
    // Newton's method from where L-BFGS got, else from where the body was.
    report.add(newton(potential, preconditioner, x, bound, NewtonSteps::guarded, most_newton));
    if (report.converged) return report;
    x = potential.start;
    potential.body.constraints.place_held(potential.time, x);
    report.add(newton(potential, preconditioner, x, bound, NewtonSteps::guarded, most_newton));
    return report;
}

}  // namespace

SolveReport implicit_step(DynamicBody& b, const Surroundings& around, ImplicitScheme scheme, double start, double dt,
                          const Threads& threads) {
    const Model& m = b.model;
    const std::size_t n = m.rest.size();
    const Difference d = difference(b.history, scheme, dt);
    const std::vector<Vec3> past_x = past(d, b.state.x, b.history.x), past_v = past(d, b.state.v, b.history.v);
    set_contact_stiffness(b, dt);

    // The potential of the step.
    IncrementalPotential potential(b, around, Precision::single, threads);
    const double drag = d.a0 / dt + around.mass_damping;
    potential.inertia = drag * d.a0 / dt;
    potential.target.resize(n);
    threads.for_each(n, node_chunk, [&](std::size_t i) {
        potential.target[i] = past_x[i] / d.a0 + past_v[i] / (dt * potential.inertia);
        potential.velocity_offset[i] = past_x[i] / dt;
    });
    potential.velocity_share = d.a0 / dt;
    potential.time = potential.load_time = start + dt;
    potential.start = b.state.x;
    WarpedPreconditioner& preconditioner =
        b.prepare_preconditioner(1 + around.stiffness_damping * d.a0 / dt, potential.inertia, threads);

    // How far the body would go by itself is what the error is measured against.
    std::vector<Vec3> x = b.state.x, loads(n);
    for (const SurfaceLoad& load : b.loads) load.add(start + dt, x, loads);
    const double way = std::sqrt(threads.sum(n, node_chunk, [&](std::size_t i) {
        const Vec3 u = dt * b.state.v[i] + dt * dt * (around.gravity + m.inverse_mass[i] * loads[i]);
        return m.mass[i] * norm_squared(u);
    }));
    const double size = std::max(way, least_way * m.node_length * std::sqrt(m.total_mass));
    const SolveTolerance bound{0, tolerance * size * std::sqrt(potential.inertia), 1e-2};

    add_scaled(x, dt, b.state.v, threads);
    b.constraints.place_held(start + dt, x);
    SolveReport report;
    preconditioner.turn(x, threads);
    potential.lag_friction(x);
    const bool rubs = b.contact && !around.colliders.empty();
    for (int pass = 0; pass < (rubs ? friction_passes : 1); ++pass) {
        if (pass > 0) {
            potential.lag_friction(x);
            if (b.rubs.empty()) break;
        }
        preconditioner.set_supports(potential.supports(x), threads);
        report.add(solve(potential, preconditioner, x, bound));
        if (!report.converged) return report;
    }

    // What the step did: the work of its forces, and what it lost by itself, which is the work of inertia and of stored
    // energy at the end of the step less what they hold now.
    const IncrementalPotential::Forces forces = potential.forces(x);
    const double before = b.step_energy ? *b.step_energy : step_energy(b, around, threads);
    std::vector<Vec3> v(n), inertial(n);
    threads.for_each(n, node_chunk, [&](std::size_t i) {
        v[i] = (d.a0 * x[i] - past_x[i]) / dt;
        inertial[i] = m.mass[i] / dt * (d.a0 * v[i] - past_v[i]);
    });
    const auto work_of = [&](auto&& force) {
        return threads.sum(n, node_chunk, [&](std::size_t i) { return dot(force(i), x[i] - b.state.x[i]); });
    };
    const Constraints::GripWork grips = b.constraints.measure(start, start + dt, x, forces.sum);
    b.exchanged.external += work_of([&](std::size_t i) { return forces.loads[i]; }) + grips.nodes + grips.patches;
    b.exchanged.damping -=
        work_of([&](std::size_t i) { return forces.viscous[i] - around.mass_damping * m.mass[i] * v[i]; });
    b.exchanged.friction -= work_of([&](std::size_t i) { return forces.friction[i]; });
    b.exchanged.numerical +=
        work_of([&](std::size_t i) { return inertial[i] - forces.conservative[i]; }) + grips.patches;

    if (b.contact) b.sticks = b.contact->sticks(b.rubs, x);
    b.history = {std::move(b.state.x), std::move(b.state.v), dt};
    b.state = {std::move(x), std::move(v)};
    b.penalty_energy = b.constraints.penalty_energy(start + dt, b.state.x);
    b.step_energy = step_energy(b, around, threads);
    b.exchanged.numerical -= *b.step_energy - before;
    return report;
}

}  // namespace phyxel
