#include "solver/step.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "solver/integrators.h"

namespace phyxel {
namespace {

using Bodies = std::span<const std::unique_ptr<DynamicBody>>;

constexpr std::size_t steps_between_estimates = 32;
constexpr int warm_iterations = 4;  ///< power iterations that go on from the last estimate

/// Shortest substep against the stable one at rest: where a step fails even with these, it fails. A body that needs
/// shorter ones is crushed; the law squeezed to a tenth of its thickness is still far from it.
constexpr double shortest_share = 1.0 / 256;

/// Energy out of nowhere, relative to the largest energy around, from which a step counts as unstable. Energy at whole
/// steps swings by up to (omega dt)^2/8 of what is in each mode, 3 % for a body full of its stiffest ones, and a step
/// thrown away for that is a biased choice: gains are done again and losses stay, 1.4 % in 1e5 steps with 0.02. A body
/// that hit a floor at four times its speed of sound kept 40 % too much with 0.25.
constexpr double tolerated_gain = 0.05;

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
        // Places are handed out in single precision.
        if (!is_finite(vector_cast<float>(b.state.x[i])) || !is_finite(b.state.v[i])) {
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
    const auto stored = [](const BodyEnergy& e) { return e.kinetic + e.stored(); };
    // Below a strain of 1e-4 everywhere there is nothing to lose.
    const double quiet = 1e-8 * b.model.largest_modulus * b.model.sampling.clipped_volume;
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

/// What is wrong with any body; empty when nothing is.
std::string trouble_with(Bodies bodies, const std::vector<Snapshot>& before, const Surroundings& around,
                         const Threads& threads) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const std::string trouble = trouble_with(*bodies[i], before[i], around, threads);
        if (!trouble.empty()) return name_of(*bodies[i], i) + ": " + trouble;
    }
    return {};
}

/// Looks again at how long steps of a body may be. Deformation lowers the limit; it never rises above that at rest, for
/// which contact is made. Returns what is wrong; empty when nothing is.
std::string update_limit(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    if (!std::isfinite(kinetic_energy(b, threads))) return "its motion is beyond all numbers";
    const double omega = b.frequency.estimate(b.model, b.state.x, warm_iterations, b.work, threads);
    if (!std::isfinite(omega)) return "its stiffness is beyond all numbers";
    // A step that changes all the time gains or loses energy, up to a quarter of it in 1e5 steps against 1e-5 with a
    // constant one: the limit is followed down when it is off by a tenth, and up again only when it is far off, so that
    // it does not swing with the motion.
    const double limit = std::min(b.rest_step, stable_step(omega, around.stiffness_damping));
    if (limit < 0.9 * b.step_limit || limit > 1.5 * b.step_limit) b.step_limit = limit;
    if (b.step_limit < shortest_share * b.rest_step)
        return "it is crushed: stable substeps fell from " + format_number(b.rest_step) + " s at rest to " +
               format_number(b.step_limit) + " s";
    return {};
}

/// Below which no substep is tried [s].
double shortest_substep(Bodies bodies) {
    double rest = bodies.front()->rest_step;
    for (const auto& b : bodies) rest = std::min(rest, b->rest_step);
    return shortest_share * rest;
}

/// One try, with substeps shortened by `shortening`. Returns what went wrong; empty when nothing did.
std::string try_advance(Bodies bodies, const std::vector<Snapshot>& before, const Surroundings& around,
                        Integrator integrator, double time, double duration, double shortening, const Threads& threads,
                        StepReport& report) {
    for (double left = duration; left > 0;) {
        const double limit = std::max(shortest_limit(bodies) * shortening, shortest_substep(bodies));
        const double needed = std::max(1.0, std::ceil(left / limit * (1 - 1e-12)));
        const double dt = left / needed;
        const auto count = static_cast<std::size_t>(std::min(needed, double(steps_between_estimates)));
        report.substep = dt;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (integrator == Integrator::verlet) verlet(*bodies[i], around, time, dt, count, threads);
            else leap_frog(*bodies[i], around, time, dt, count, threads);
            const std::string trouble = update_limit(*bodies[i], around, threads);
            if (!trouble.empty()) return name_of(*bodies[i], i) + ": " + trouble;
        }
        report.substeps += count;
        left = static_cast<double>(count) == needed ? 0 : left - static_cast<double>(count) * dt;
        time += static_cast<double>(count) * dt;

        // Whatever failed once is watched closely, so that the next failure is seen early.
        if (left > 0 && shortening == 1) continue;
        const std::string trouble = trouble_with(bodies, before, around, threads);
        if (!trouble.empty()) return trouble;
    }
    return {};
}

}  // namespace

BodyEnergy body_energy(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    BodyEnergy e;
    e.kinetic = kinetic_energy(b, threads);
    e.elastic = elastic_energy(b.model, b.state.x, b.work, threads);
    e.stabilization = stabilization_energy(b.model, b.state.x, b.work, threads);
    e.gravitational = -threads.sum(b.state.x.size(), 1024,
                                   [&](std::size_t i) { return b.model.mass[i] * dot(around.gravity, b.state.x[i]); });
    e.contact = b.body_contact_energy;
    if (b.contact) e.contact += b.contact->energy(around.colliders, b.state.x, threads);
    e.constraint = b.penalty_energy;
    return e;
}

void estimate_rest_step(DynamicBody& b, const Surroundings& around, const Threads& threads) {
    b.frequency = {};  // so that the estimate does not depend on what the body went through
    const double omega = b.frequency.estimate_at_rest(b.model, b.work, threads);
    b.rest_step = b.step_limit = stable_step(omega, around.stiffness_damping);
}

StepReport advance(Bodies bodies, const Surroundings& around, Integrator integrator, double time, double duration,
                   const Threads& threads) {
    StepReport report;
    if (bodies.empty()) {
        report.advanced = duration;
        return report;
    }
    if (!is_explicit(integrator)) return advance_implicitly(bodies, around, integrator, time, duration, threads);
    const std::vector<Snapshot> before = take_snapshots(bodies, around, threads);
    std::string trouble;
    for (double shortening = 1; shortening >= shortest_share; shortening /= 2) {
        for (const auto& b : bodies) b->constraints.start_measuring();
        report.substeps = 0;
        trouble = try_advance(bodies, before, around, integrator, time, duration, shortening, threads, report);
        if (trouble.empty()) {
            report.advanced = duration;
            for (const auto& b : bodies) report.contacts += b->touches.size();
            return report;
        }
        restore(bodies, before);
        for (const auto& b : bodies) b->constraints.start_measuring();
        ++report.retries;
        if (report.substep <= shortest_substep(bodies)) break;
    }
    report.status = StepStatus::failed;
    report.substeps = 0;
    report.message =
        "no stable step from time " + format_number(time) + " s, even with substeps of " +
        format_number(report.substep) + " s: " + trouble +
        ". The state is the last good one. A stiffer law (neo-hookean), a finer spacing or gentler loads may help";
    return report;
}

}  // namespace phyxel
