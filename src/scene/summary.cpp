#include "scene/summary.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "phyxel/version.h"

namespace phyxel {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

std::size_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

Json bodies_json(const Scene& scene, const BuiltScene& built) {
    Json all = Json::object();
    for (std::size_t i = 0; i < built.bodies.size(); ++i) {
        const BodyReport body = built.world.report(built.bodies[i]);
        all[scene.bodies[i].name] = {{"nodes", body.nodes},
                                     {"quadrature_points", body.quadrature_points},
                                     {"mean_neighbors", body.mean_neighbors},
                                     {"spacing", body.spacing},
                                     {"mass", body.mass},
                                     {"rest_volume", body.rest_volume},
                                     {"mesh_volume", body.mesh_volume},
                                     {"volume", body.volume},
                                     {"fragments", body.fragments}};
    }
    return all;
}

Json energy_json(const EnergyLedger& energy) {
    return {{"kinetic", energy.kinetic},
            {"elastic", energy.elastic},
            {"stabilization", energy.stabilization},
            {"constraint", energy.constraint},
            {"gravitational", energy.gravitational},
            {"plastic", energy.plastic},
            {"fracture", energy.fracture},
            {"contact", energy.contact},
            {"friction", energy.friction},
            {"damping", energy.damping},
            {"external_work", energy.external_work},
            {"numerical", energy.numerical},
            {"balance_error", energy.balance_error}};
}

Json probes_json(const Scene& scene, const BuiltScene& built) {
    Json all = Json::object();
    for (std::size_t i = 0; i < built.probes.size(); ++i) {
        const ProbeReading reading = built.world.probe(built.probes[i]);
        all[scene.probes[i].name] = {{"rest", json(reading.rest)},
                                     {"position", json(reading.position)},
                                     {"displacement", json(reading.position - reading.rest)}};
    }
    return all;
}

Json fixes_json(const Scene& scene, const BuiltScene& built) {
    Json all = Json::object();
    for (std::size_t i = 0; i < built.fixes.size(); ++i) {
        const Reaction reaction = built.world.reaction(built.fixes[i]);
        all[scene.fixes[i].name] = {{"force", json(reaction.force)}, {"torque", json(reaction.torque)}};
    }
    return all;
}

std::string method(const SceneSimulation& simulation) {
    const auto name = [&]() -> std::string {
        switch (simulation.solver.method) {
            case SolverMethod::l_bfgs:
                return "L-BFGS with warped multigrid";
            case SolverMethod::newton:
                return "Newton and conjugate gradients with warped multigrid";
            case SolverMethod::single_newton:
                break;
        }
        return "one Newton iteration";
    };
    switch (simulation.integrator) {
        case Integrator::leap_frog:
            return "leap-frog";
        case Integrator::verlet:
            return "verlet";
        case Integrator::implicit_euler:
            return "implicit-euler, " + name();
        case Integrator::bdf2:
            return "bdf2, " + name();
        case Integrator::statics:
            break;
    }
    return "static, Newton and conjugate gradients with warped multigrid";
}

/// 0 for explicit integrators.
double tolerance(const SceneSimulation& simulation) {
    if (is_explicit(simulation.integrator)) return 0;
    if (simulation.solver.tolerance > 0) return simulation.solver.tolerance;
    return simulation.integrator == Integrator::statics ? default_static_tolerance : default_step_tolerance;
}

/// Explicit integrators solve nothing: their iterations are zero, and what counts is the steps they took.
Json solver_json(const Scene& scene, const RunRecord& record) {
    return {{"method", method(scene.simulation)},
            {"tolerance", tolerance(scene.simulation)},
            {"newton_iterations", record.newton_iterations},
            {"newton_iterations_worst", record.newton_worst},
            {"linear_iterations", record.linear_iterations},
            {"linear_iterations_worst", record.linear_worst},
            {"smallest_step", record.smallest_step},
            {"retries", record.retries}};
}

Json warnings_json(const World& world) {
    Json all = Json::array();
    for (const Warning& warning : world.warnings())
        all.push_back({{"message", warning.message}, {"count", warning.count}});
    return all;
}

}  // namespace

std::string summary_json(const Scene& scene, const BuiltScene& built, const RunRecord& record) {
    const World& world = built.world;
    const double rate = record.wall_seconds > 0 ? static_cast<double>(record.steps) / record.wall_seconds : 0;
    const Json summary = {{"status", record.status},
                          {"message", record.message},
                          {"version", version},
                          {"scene", scene.text->path().string()},
                          {"title", scene.title},
                          {"threads", record.threads},
                          {"steps", record.steps},
                          {"frames", record.frames},
                          {"simulated_seconds", world.time()},
                          {"resumed_from", record.resumed_from},
                          {"wall_seconds", record.wall_seconds},
                          {"setup_seconds", record.setup_seconds},
                          {"steps_per_second", rate},
                          {"peak_memory_bytes", peak_memory_bytes()},
                          {"state_hash", fmt::format("{:016x}", world.state_hash())},
                          {"warnings", warnings_json(world)},
                          {"bodies", bodies_json(scene, built)},
                          {"energy", energy_json(world.energy())},
                          {"probes", probes_json(scene, built)},
                          {"fixes", fixes_json(scene, built)},
                          {"solver", solver_json(scene, record)}};
    return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace phyxel
