#include "solver/step.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "solver/integrators.h"

namespace phyxel {
namespace {

using Bodies = std::span<const std::unique_ptr<DynamicBody>>;

constexpr std::size_t steps_between_estimates = 32;
constexpr int rest_iterations = 60;  ///< power iterations for a new body
constexpr int warm_iterations = 4;   ///< power iterations that go on from the last estimate
constexpr int halvings = 8;

/// Energy out of nowhere, relative to the largest energy around, from which a step counts as unstable. Explicit contact
/// and fast crushing err by some per cent; an instability multiplies.
constexpr double tolerated_gain = 0.25;

struct Snapshot {
    State state;
    Exchanged exchanged;
    LargestFrequency frequency;
    double step_limit;
    BodyEnergy energy;
};

std::vector<Snapshot> take_snapshots(Bodies bodies, const Surroundings& around, const Threads& threads) {
    std::vector<Snapshot> snapshots;
    for (const auto& b : bodies)
        snapshots.push_back({b->state, b->exchanged, b->frequency, b->step_limit, body_energy(*b, around, threads)});
    return snapshots;
}

void restore(Bodies bodies, const std::vector<Snapshot>& snapshots) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        bodies[i]->state = snapshots[i].state;
        bodies[i]->exchanged = snapshots[i].exchanged;
        bodies[i]->frequency = snapshots[i].frequency;
        bodies[i]->step_limit = snapshots[i].step_limit;
    }
}

/// What is wrong with a body after a step; empty when nothing is.
std::string trouble_with(DynamicBody& b, const Snapshot& before, const Surroundings& around, const Threads& threads) {
    const Vec3 start = before.state.x.front();
    for (std::size_t i = 0; i < b.state.x.size(); ++i)
        if (!is_finite(b.state.x[i]) || !is_finite(b.state.v[i])) {
            return "node " + std::to_string(i) + " at rest position " + format_point(b.model.rest[i]) +
                   " left the numbers";
        }
    const BodyEnergy after = body_energy(b, around, threads);
    const double external = b.exchanged.external - before.exchanged.external;
    const double lost =
        b.exchanged.damping + b.exchanged.friction - before.exchanged.damping - before.exchanged.friction;
    const double gain = after.total() - before.energy.total() - external + lost;
    const double weight =
        norm(around.gravity) * b.model.total_mass * (norm(b.state.x.front() - start) + b.model.node_length);
    const auto stored = [](const BodyEnergy& e) { return e.kinetic + e.elastic + e.stabilization + e.contact; };
    // Below a strain of 1e-4 everywhere there is nothing to lose.
    const double quiet = 1e-8 * b.model.settings.youngs_modulus * b.model.sampling.clipped_volume;
    const double scale = std::max({stored(after), stored(before.energy), std::abs(external), lost, weight, quiet});
    if (gain <= tolerated_gain * scale) return {};
    return "energy grew by " + format_number(gain) + " J out of nowhere, more than is stored (" +
           format_number(stored(after)) + " J)";
}

double shortest_limit(Bodies bodies) {
    double limit = bodies.front()->step_limit;
    for (const auto& b : bodies) limit = std::min(limit, b->step_limit);
    return limit;
}

/// One try, with substeps shortened by `shortening`. Stops early where something is no longer finite.
void try_advance(Bodies bodies, const Surroundings& around, Integrator integrator, double time, double duration,
                 double shortening, const Threads& threads, StepReport& report) {
    for (double left = duration; left > 0;) {
        const double limit = shortest_limit(bodies) * shortening;
        const double needed = std::max(1.0, std::ceil(left / limit * (1 - 1e-12)));
        const double dt = left / needed;
        const auto count = static_cast<std::size_t>(std::min(needed, double(steps_between_estimates)));
        for (const auto& b : bodies) {
            if (integrator == Integrator::verlet) verlet(*b, around, time, dt, count, threads);
            else leap_frog(*b, around, time, dt, count, threads);
            if (!std::isfinite(kinetic_energy(*b, threads))) return;
            // Deformation lowers the limit; it never rises above that at rest, for which contact is made.
            const double omega = b->frequency.estimate(b->model, b->state.x, warm_iterations, b->work, threads);
            if (!std::isfinite(omega)) return;
            b->step_limit = std::min(b->rest_step, stable_step(omega, around.stiffness_damping));
        }
        report.substeps += count;
        report.substep = dt;
        left = static_cast<double>(count) == needed ? 0 : left - static_cast<double>(count) * dt;
        time += static_cast<double>(count) * dt;
    }
}

}  // namespace

BodyEnergy body_energy(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    BodyEnergy e;
    e.kinetic = kinetic_energy(b, threads);
    e.elastic = elastic_energy(b.model, b.state.x, b.work, threads);
    e.stabilization = stabilization_energy(b.model, b.state.x, b.work, threads);
    e.gravitational = -threads.sum(b.state.x.size(), 1024,
                                   [&](std::size_t i) { return b.model.mass[i] * dot(around.gravity, b.state.x[i]); });
    if (b.contact) e.contact = b.contact->energy(around.colliders, b.state.x, threads);
    return e;
}

void estimate_rest_step(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    const double omega = b.frequency.estimate(b.model, b.model.rest, rest_iterations, b.work, threads);
    b.rest_step = b.step_limit = stable_step(omega, around.stiffness_damping);
}

StepReport advance(Bodies bodies, const Surroundings& around, Integrator integrator, double time, double duration,
                   const Threads& threads) {
    StepReport report;
    if (bodies.empty()) {
        report.advanced = duration;
        return report;
    }
    const std::vector<Snapshot> before = take_snapshots(bodies, around, threads);
    std::string trouble;
    double shortening = 1;
    for (int attempt = 0; attempt <= halvings; ++attempt, shortening /= 2) {
        for (const auto& b : bodies) b->constraints.start_measuring();
        report.substeps = 0;
        try_advance(bodies, around, integrator, time, duration, shortening, threads, report);
        trouble.clear();
        for (std::size_t i = 0; i < bodies.size() && trouble.empty(); ++i) {
            trouble = trouble_with(*bodies[i], before[i], around, threads);
            if (!trouble.empty()) trouble = "body " + std::to_string(i) + ": " + trouble;
        }
        if (trouble.empty()) {
            report.advanced = duration;
            for (const auto& b : bodies) report.contacts += b->touches.size();
            return report;
        }
        restore(bodies, before);
        ++report.retries;
    }
    report.status = StepStatus::failed;
    report.substeps = 0;
    report.message =
        "no stable step from time " + format_number(time) + " s, even with substeps of " +
        format_number(shortest_limit(bodies) * shortening * 2) + " s: " + trouble +
        ". The state is the last good one. A stiffer law (neo-hookean), a finer spacing or gentler loads may help";
    return report;
}

}  // namespace phyxel
