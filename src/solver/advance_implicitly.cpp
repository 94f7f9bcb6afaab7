#include <algorithm>
#include <optional>

#include "base/format.h"
#include "solver/implicit_step.h"
#include "solver/statics.h"
#include "solver/step.h"

namespace phyxel {
namespace {

using Bodies = std::span<const std::unique_ptr<DynamicBody>>;

constexpr int most_parts = 64;  ///< equal steps that one which was not found is cut into

/// What changes in a step and is put back when it fails.
struct Before {
    State state;
    History history;
    Exchanged exchanged;
    std::vector<ContactSamples::Stick> sticks;
    std::vector<BodyStick> body_sticks;
    double penalty_energy, body_contact_energy, carried_load;
    std::optional<double> step_energy;
};

void restore(Bodies bodies, const std::vector<Before>& before) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        bodies[i]->state = before[i].state;
        bodies[i]->history = before[i].history;
        bodies[i]->step_energy = before[i].step_energy;
        bodies[i]->exchanged = before[i].exchanged;
        bodies[i]->sticks = before[i].sticks;
        bodies[i]->body_sticks = before[i].body_sticks;
        bodies[i]->penalty_energy = before[i].penalty_energy;
        bodies[i]->body_contact_energy = before[i].body_contact_energy;
        bodies[i]->carried_load = before[i].carried_load;
    }
}

void count(const SolveReport& solve, StepReport& report) {
    report.newton_iterations += solve.newton_iterations;
    report.newton_worst = std::max(report.newton_worst, solve.newton_iterations);
    report.linear_iterations += solve.linear_iterations;
    report.linear_worst = std::max(report.linear_worst, solve.linear_worst);
}

bool all_finite(const State& state) {
    for (std::size_t i = 0; i < state.x.size(); ++i)
        // Places are handed out in single precision.
        if (!is_finite(vector_cast<float>(state.x[i])) || !is_finite(state.v[i])) return false;
    return true;
}

/// What is solved together.
std::vector<std::vector<std::uint32_t>> groups(Bodies bodies, const Surroundings& around, Integrator integrator,
                                               double end, double dt) {
    if (integrator != Integrator::statics) return groups_that_may_touch(bodies, around, end, dt);
    std::vector<std::vector<std::uint32_t>> alone;
    for (std::uint32_t i = 0; i < bodies.size(); ++i) alone.push_back({i});
    return alone;
}

std::string names_of(Bodies bodies, const std::vector<std::uint32_t>& group) {
    std::string text;
    for (std::size_t i = 0; i < group.size(); ++i)
        text += (i == 0 ? "" : i + 1 < group.size() ? ", " : " and ") + name_of(*bodies[group[i]], group[i]);
    return text;
}

/// What went wrong in `parts` equal steps; empty when nothing did.
std::string try_steps(Bodies bodies, const Surroundings& around, Integrator integrator, double time, double duration,
                      int parts, const Threads& threads, StepReport& report) {
    const ImplicitScheme scheme = integrator == Integrator::bdf2 ? ImplicitScheme::bdf2 : ImplicitScheme::euler;
    const double dt = duration / parts;
    report.substep = dt;
    for (int k = 0; k < parts; ++k) {
        for (const std::vector<std::uint32_t>& group : groups(bodies, around, integrator, time + (k + 1) * dt, dt)) {
            const SolveReport solve =
                integrator == Integrator::statics
                    ? find_equilibrium(*bodies[group.front()], around, time, time + duration, threads)
                    : implicit_step(bodies, group, around, scheme, time + k * dt, dt, threads);
            count(solve, report);
            if (!solve.converged) return names_of(bodies, group) + ": " + solve.trouble;
            for (std::uint32_t number : group)
                if (!all_finite(bodies[number]->state)) return name_of(*bodies[number], number) + " left the numbers";
        }
        ++report.substeps;
    }
    return {};
}

}  // namespace

StepReport advance_implicitly(Bodies bodies, const Surroundings& around, Integrator integrator, double time,
                              double duration, const Threads& threads) {
    StepReport report;
    std::vector<Before> before;
    for (const auto& b : bodies)
        before.push_back({b->state, b->history, b->exchanged, b->sticks, b->body_sticks, b->penalty_energy,
                          b->body_contact_energy, b->carried_load, b->step_energy});
    const bool is_static = integrator == Integrator::statics;
    std::string trouble;
    for (int parts = 1; parts <= (is_static ? 1 : most_parts); parts *= 2) {
        for (const auto& b : bodies) b->constraints.start_measuring();
        report.substeps = 0;
        trouble = try_steps(bodies, around, integrator, time, duration, parts, threads, report);
        if (trouble.empty()) {
            report.advanced = duration;
            for (const auto& b : bodies) report.contacts += b->touches.size() + b->body_touches;
            return report;
        }
        restore(bodies, before);
        for (const auto& b : bodies) b->constraints.start_measuring();
        ++report.retries;
    }
    report.status = StepStatus::failed;
    report.substeps = 0;
    report.message =
        (is_static ? "no equilibrium was found: " + trouble
                   : "no implicit step from time " + format_number(time) + " s was found, even in parts of " +
                         format_number(report.substep) + " s: " + trouble) +
        ". The state is the last good one. A stiffer law (neo-hookean), a finer spacing or gentler loads "
        "may help";
    return report;
}

}  // namespace phyxel
