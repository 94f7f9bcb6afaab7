#include <fmt/format.h>

#include <cmath>

#include "scene/read_parts.h"

namespace phyxel {
namespace {

constexpr double most_frames = 1e7;  // six digits number the files; a tenfold reserve
constexpr double most_steps = 1e9;   // beyond, the rounding of their times shows

constexpr Choice<Integrator> integrators[] = {
    {"implicit-euler", Integrator::implicit_euler},
    {"bdf2", Integrator::bdf2},
    {"static", Integrator::statics},
    {"leap-frog", Integrator::leap_frog},
    {"verlet", Integrator::verlet},
    {"constraint", Integrator::verlet, false},
    {"auto", Integrator::verlet, false},
};

constexpr Choice<SolverMethod> methods[] = {
    {"l-bfgs", SolverMethod::l_bfgs},
    {"newton", SolverMethod::newton},
    {"single-newton", SolverMethod::single_newton},
};
constexpr Choice<Tangent> tangents[] = {{"exact", Tangent::exact}, {"brunet-2019", Tangent::brunet_2019}};
constexpr Choice<SolverPrecision> precisions[] = {{"single", SolverPrecision::single},
                                                  {"double", SolverPrecision::full}};

SolverSettings read_solver(const TableReader& simulation, Integrator integrator) {
    SolverSettings settings;
    const auto reader = simulation.table("solver", {"method", "tolerance", "tangent", "precision"});
    if (!reader) return settings;
    if (is_explicit(integrator))
        simulation.fail("solver",
                        "explicit integrators solve nothing; remove it, or use integrator = "
                        "\"implicit-euler\", \"bdf2\" or \"static\"");
    settings.method = reader->choice<SolverMethod>("method", methods).value_or(settings.method);
    if (integrator == Integrator::statics && settings.method == SolverMethod::single_newton)
        reader->fail("method", "one Newton iteration is a step of implicit-euler or bdf2 and finds no equilibrium");
    settings.tolerance = reader->number("tolerance", between(1e-12, 0.5)).value_or(settings.tolerance);
    settings.tangent = reader->choice<Tangent>("tangent", tangents).value_or(settings.tangent);
    settings.precision = reader->choice<SolverPrecision>("precision", precisions).value_or(settings.precision);
    return settings;
}

std::optional<double> read_time_step(const TableReader& reader) {
    constexpr Choice<bool> words[] = {{"auto", true}};
    if (!reader.has("time_step")) return {};
    if (reader.is_string("time_step")) {
        reader.choice<bool>("time_step", words);
        return {};
    }
    return reader.number("time_step", above(0, "s"));
}

}  // namespace

SceneSimulation read_simulation(const TableReader& root) {
    SceneSimulation simulation;
    const auto reader =
        root.table("simulation", {"integrator", "time_step", "duration", "frame_rate", "gravity", "damping", "solver"});
    if (!reader) return simulation;
    simulation.integrator = reader->choice<Integrator>("integrator", integrators).value_or(simulation.integrator);
    simulation.time_step = read_time_step(*reader);
    simulation.duration = reader->number("duration", above(0, "s")).value_or(simulation.duration);
    simulation.frame_rate = reader->number("frame_rate", above(0, "1/s")).value_or(simulation.frame_rate);
    simulation.gravity = reader->vector("gravity", any("m/s^2")).value_or(simulation.gravity);
    if (const auto damping = reader->table("damping", {"mass", "stiffness"})) {
        simulation.mass_damping = damping->number("mass", at_least(0, "1/s")).value_or(0);
        simulation.stiffness_damping = damping->number("stiffness", at_least(0, "s")).value_or(0);
    }

    simulation.solver = read_solver(*reader, simulation.integrator);

    // A static run is one step and one frame of results; implicit steps divide the frames
    if (simulation.integrator == Integrator::statics) {
        simulation.time_step = simulation.duration;
        simulation.frame_rate = 1 / simulation.duration;
    } else if (!is_explicit(simulation.integrator) && !simulation.time_step) {
        simulation.time_step = 1 / (simulation.frame_rate * std::ceil(60 / simulation.frame_rate * (1 - 1e-12)));
    }

    // Runs that could not end are mistakes of unit
    if (simulation.duration * simulation.frame_rate > most_frames)
        reader->fail(reader->has("duration") ? "duration" : "frame_rate",
                     fmt::format("{:g} s at {:g} frames a second are more than {:g} frames; lower one of the two",
                                 simulation.duration, simulation.frame_rate, most_frames));
    if (simulation.time_step && simulation.duration / *simulation.time_step > most_steps)
        reader->fail("time_step", fmt::format("{:g} s take more than 1e9 such steps; raise it, or use \"auto\"",
                                              simulation.duration));
    return simulation;
}

}  // namespace phyxel
