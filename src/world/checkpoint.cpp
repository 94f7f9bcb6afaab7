#include <cmath>
#include <limits>
#include <string>

#include "base/hash.h"
#include "phyxel/error.h"
#include "phyxel/version.h"
#include "phyxel/world.h"
#include "world/checkpoint_file.h"
#include "world/make_body.h"
#include "world/parts.h"

namespace phyxel {
namespace {

void add_material(Hasher& hasher, const Material& m) {
    for (double value : {m.density, m.youngs_modulus, m.poissons_ratio, m.volume_stiffness}) hasher.add_value(value);
    hasher.add_value(static_cast<std::uint64_t>(m.law));
}

/// Hash of all that a checkpoint does not hold and a resumed run must share: nodes, masses, gradients, materials,
/// obstacles, fixes, loads, contact surfaces.
std::uint64_t fingerprint(const World::Parts& p) {
    Hasher hasher;
    hasher.add_value(p.settings.time_step);
    hasher.add_value(p.around.gravity);
    hasher.add_value(p.around.mass_damping);
    hasher.add_value(p.around.stiffness_damping);
    hasher.add_value(static_cast<std::uint64_t>(p.settings.integrator));
    const SolverSettings& solver = p.settings.solver;
    for (int choice : {int(solver.method), int(solver.tangent), int(solver.precision)}) hasher.add_value(choice);
    hasher.add_value(solver.tolerance);
    for (const Collider& collider : p.around.colliders) collider.add_to(hasher);
    for (const auto& body : p.bodies) {
        const Model& m = body->model;
        hasher.add_values(std::span<const Vec3>(m.rest));
        hasher.add_values(std::span<const double>(m.mass));
        hasher.add_values(std::span<const double>(m.volumes));
        hasher.add_values(std::span<const Vec3>(m.stencils.gradient));
        add_material(hasher, m.settings);
        for (const Material& material : m.mixture.materials) add_material(hasher, material);
        hasher.add_values(std::span<const double>(m.mixture.share));
        hasher.add_values(std::span<const std::uint16_t>(m.mixture.material));
        hasher.add_values(std::span<const std::uint32_t>(m.dilatation.cell));
        for (double value : {m.stabilization, body->rest_step}) hasher.add_value(value);
        for (const SurfaceLoad& load : body->loads) load.add_to(hasher);
        body->constraints.add_to(hasher);
        hasher.add_value(body->friction);
        if (body->separate_contact_surface) body->contact->add_to(hasher);
    }
    return hasher.value();
}

/// Of a number that is not there.
constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::string section(std::size_t body, const char* what) { return "body." + std::to_string(body) + "." + what; }

}  // namespace

void World::save_checkpoint(const std::filesystem::path& path) const {
    const Parts& p = *parts_;
    CheckpointWriter file;
    file.add_value("fingerprint", fingerprint(p));
    file.add_value("time", p.time);
    file.add_value("largest_energy", p.largest_energy);
    for (std::size_t i = 0; i < p.bodies.size(); ++i) {
        DynamicBody& body = *p.bodies[i];
        file.add_values(section(i, "x"), std::span<const Vec3>(body.state.x));
        file.add_values(section(i, "v"), std::span<const Vec3>(body.state.v));
        file.add_values(section(i, "mode"), std::span<const Vec3>(body.frequency.mode()));
        file.add_value(section(i, "step_limit"), body.step_limit);
        file.add_value(section(i, "exchanged"), body.exchanged);
        file.add_value(section(i, "penalty_energy"), body.penalty_energy);
        file.add_value(section(i, "carried_load"), body.carried_load);
        file.add_value(section(i, "sticks.count"), std::uint64_t{body.sticks.size()});
        file.add_values(section(i, "sticks"), std::span<const ContactSamples::Stick>(body.sticks));
        file.add_value(section(i, "body_sticks.count"), std::uint64_t{body.body_sticks.size()});
        file.add_values(section(i, "body_sticks"), std::span<const BodyStick>(body.body_sticks));
        file.add_value(section(i, "body_contact_energy"), body.body_contact_energy);
        file.add_value(section(i, "apart.count"), std::uint64_t{body.apart.size()});
        file.add_values(section(i, "apart"), std::span<const std::uint32_t>(body.apart));
        file.add_value(section(i, "step_energy"), body.step_energy.value_or(none));
        file.add_value(section(i, "history.dt"), body.history.dt);
        file.add_value(section(i, "history.trend"), body.history.trend);
        file.add_values(section(i, "history.x"), std::span<const Vec3>(body.history.x));
        file.add_values(section(i, "history.v"), std::span<const Vec3>(body.history.v));
        file.add_value(section(i, "energy_at_start"), p.infos[i].energy_at_start);
        file.add_value(section(i, "gravity_at_start"), p.infos[i].gravity_at_start);
    }
    file.write(path);
}

void World::load_checkpoint(const std::filesystem::path& path) {
    Parts& p = *parts_;
    const CheckpointReader file(path);
    if (file.value<std::uint64_t>("fingerprint") != fingerprint(p))
        throw Error(path.string() + ": this checkpoint is of another world (written by version " +
                    file.library_version() +
                    "): its bodies, materials, settings or obstacles differ from the scene's. Resume with the scene "
                    "and the --set "
                    "values that wrote it");
    // All is read before anything changes.
    std::vector<State> states;
    std::vector<std::vector<Vec3>> modes;
    std::vector<History> histories;
    std::vector<std::vector<ContactSamples::Stick>> sticks;
    std::vector<std::vector<BodyStick>> body_sticks;
    std::vector<std::vector<std::uint32_t>> apart;
    for (std::size_t i = 0; i < p.bodies.size(); ++i) {
        const std::size_t n = p.bodies[i]->model.rest.size();
        states.push_back({file.values<Vec3>(section(i, "x"), n), file.values<Vec3>(section(i, "v"), n)});
        modes.push_back(file.values<Vec3>(section(i, "mode"), is_explicit(p.settings.integrator) ? n : 0));
        for (const char* what : {"step_limit", "energy_at_start", "gravity_at_start", "penalty_energy", "carried_load",
                                 "body_contact_energy", "step_energy"})
            (void)file.value<double>(section(i, what));
        sticks.push_back(file.values<ContactSamples::Stick>(section(i, "sticks"),
                                                            file.value<std::uint64_t>(section(i, "sticks.count"))));
        body_sticks.push_back(file.values<BodyStick>(section(i, "body_sticks"),
                                                     file.value<std::uint64_t>(section(i, "body_sticks.count"))));
        apart.push_back(
            file.values<std::uint32_t>(section(i, "apart"), file.value<std::uint64_t>(section(i, "apart.count"))));
        const double last_step = file.value<double>(section(i, "history.dt"));
        const std::size_t kept = last_step > 0 ? n : 0;
        histories.push_back({file.values<Vec3>(section(i, "history.x"), kept),
                             file.values<Vec3>(section(i, "history.v"), kept), last_step,
                             file.value<double>(section(i, "history.trend"))});
        (void)file.value<Exchanged>(section(i, "exchanged"));
    }
    p.time = file.value<double>("time");
    p.largest_energy = file.value<double>("largest_energy");
    for (std::size_t i = 0; i < p.bodies.size(); ++i) {
        DynamicBody& body = *p.bodies[i];
        body.state = std::move(states[i]);
        body.history = std::move(histories[i]);
        const double step_energy = file.value<double>(section(i, "step_energy"));
        body.step_energy = std::isnan(step_energy) ? std::nullopt : std::optional(step_energy);
        body.apart = std::move(apart[i]);
        prepare_contact(body, p);
        body.sticks = std::move(sticks[i]);
        body.body_sticks = std::move(body_sticks[i]);
        body.body_contact_energy = file.value<double>(section(i, "body_contact_energy"));
        body.penalty_energy = file.value<double>(section(i, "penalty_energy"));
        body.carried_load = file.value<double>(section(i, "carried_load"));
        body.frequency.mode() = std::move(modes[i]);
        body.step_limit = file.value<double>(section(i, "step_limit"));
        body.exchanged = file.value<Exchanged>(section(i, "exchanged"));
        p.infos[i].energy_at_start = file.value<double>(section(i, "energy_at_start"));
        p.infos[i].gravity_at_start = file.value<double>(section(i, "gravity_at_start"));
        body.surface->update(body.state.x, p.threads);
    }
}

}  // namespace phyxel
