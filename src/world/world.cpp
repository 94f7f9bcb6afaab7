#include "phyxel/world.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/hash.h"
#include "phyxel/error.h"
#include "world/make_body.h"
#include "world/parts.h"

namespace phyxel {
namespace {

void check_settings(const WorldSettings& s) {
    if (!(s.time_step > 0) || !std::isfinite(s.time_step))
        throw Error("time_step: found " + format_number(s.time_step) + ", expected a finite number above 0 [s]");
    if (!is_finite(s.gravity)) throw Error("gravity: expected finite numbers [m/s^2]");
    if (!(s.mass_damping >= 0) || !std::isfinite(s.mass_damping))
        throw Error("mass_damping: found " + format_number(s.mass_damping) +
                    ", expected a finite number of at least 0 [1/s]");
    if (!(s.stiffness_damping >= 0) || !std::isfinite(s.stiffness_damping))
        throw Error("stiffness_damping: found " + format_number(s.stiffness_damping) +
                    ", expected a finite number of at least 0 [s]");
    if (!(s.solver.tolerance >= 0 && s.solver.tolerance <= 0.5))
        throw Error("solver.tolerance: found " + format_number(s.solver.tolerance) +
                    ", expected 0 to 0.5, or 0 for the default");
    if (s.threads < 0 || s.threads > 1024)
        throw Error("threads: found " + std::to_string(s.threads) +
                    ", expected 1 to 1024, or 0 for all of the machine's");
}

/// A point's parts are of one law.
void refuse_blended_laws(const Mixture& mixture, std::size_t which, const Material& material) {
    for (std::size_t k = 0; k < mixture.share.size(); ++k)
        if (mixture.material[k] == which && mixture.share[k] < 1 && mixture.materials[which].law != material.law)
            throw Error(
                "material law: octants or transitions at the border of a region blend this material with another; "
                "give it the law it had");
}

void check_box(const BoxSelection& box, const char* what) {
    for (int c = 0; c < 3; ++c)
        if (!(box.lower[c] <= box.upper[c]))
            throw Error(std::string(what) + " box: its lower corner is above its upper one; swap them");
}

void check_tangent(const SolverSettings& solver, const Material& material) {
    if (solver.tangent == Tangent::brunet_2019 && material.law != Law::corotated)
        throw Error(
            "material law: solver.tangent brunet-2019 belongs to the corotated law. Use that law, or the exact "
            "tangent");
}

bool bodies_meet(Integrator integrator) {
    return integrator == Integrator::implicit_euler || integrator == Integrator::bdf2;
}

/// Whether a body in the world, one of `bodies`, may touch something.
bool something_to_touch(const World::Parts& p, std::size_t bodies) {
    return !p.around.colliders.empty() || (bodies > 1 && bodies_meet(p.settings.integrator));
}

template <class Shape>
std::size_t add_collider(World::Parts& p, const Shape& shape) {
    p.around.colliders.emplace_back(shape);
    for (const auto& body : p.bodies) make_contact(*body, p);
    return p.around.colliders.size() - 1;
}

/// Bodies that begin inside of each other stay that way: pushed apart, they would burst.
void let_overlapping_pass(World::Parts& p, DynamicBody& added) {
    const auto number = static_cast<std::uint32_t>(p.bodies.size());
    for (std::uint32_t i = 0; i < number; ++i) {
        DynamicBody& other = *p.bodies[i];
        std::vector<Vec3> x = other.state.x;
        x.insert(x.end(), added.state.x.begin(), added.state.x.end());
        BodyContact contact({{&*other.contact, i, 0, other.state.x.size(), 0, other.model.sampling.spacing, {}, {}},
                             {&*added.contact,
                              number,
                              other.state.x.size(),
                              added.state.x.size(),
                              0,
                              added.model.sampling.spacing,
                              {},
                              {}}});
        contact.find(
            x, x, norm(added.contact->reach(added.state.x).size()) + norm(other.contact->reach(other.state.x).size()),
            p.threads);
        const double depth = contact.deepest(x);
        if (depth <= 0.1 * std::min(other.model.sampling.spacing, added.model.sampling.spacing)) continue;
        added.apart.push_back(i);
        other.apart.push_back(number);
        p.warn(name_of(added, number) + " begins " + format_number(depth) + " m inside of " + name_of(other, i) +
               ": these two pass through each other. Move one of them to let them meet");
    }
}

void warn_of_open_contact(World::Parts& p, const DynamicBody& body, std::size_t number) {
    if (!body.contact->has_inside())
        p.warn("the contact surface of " + name_of(body, number) +
               " is not closed: its points are kept out of other bodies, but "
               "theirs are not kept out of it. Close it where it should hold them");
}

/// Renumbers what names bodies after one was removed.
void forget_number(DynamicBody& body, std::uint32_t removed) {
    std::erase(body.apart, removed);
    std::erase_if(body.body_sticks, [&](const BodyStick& stick) { return stick.other == removed; });
    for (std::uint32_t& number : body.apart) number -= number > removed;
    for (BodyStick& stick : body.body_sticks) stick.other -= stick.other > removed;
}

}  // namespace

std::size_t World::Parts::index_of(BodyId id) const {
    if (id.index >= slots.size() || !slots[id.index].alive || slots[id.index].generation != id.generation)
        throw Error("this body is not, or no longer, in the world");
    return slots[id.index].body;
}

World::World(const WorldSettings& settings) : parts_(std::make_unique<Parts>()) {
    check_settings(settings);
    parts_->settings = settings;
    parts_->threads = settings.parallel_for ? Threads(settings.parallel_for) : Threads(settings.threads);
    parts_->around = {settings.gravity, settings.mass_damping, settings.stiffness_damping, {}, settings.solver};
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

BodyId World::add_body(const TriangleMesh& mesh, const BodySettings& settings) {
    Parts& p = *parts_;
    check_tangent(p.settings.solver, settings.material);
    for (const Region& region : settings.regions) check_tangent(p.settings.solver, region.material);
    Parts::BodyInfo info;
    auto body = make_body(mesh, settings, p, info.mesh_report);
    if (something_to_touch(p, p.bodies.size() + 1)) {
        for (const auto& other : p.bodies) make_contact(*other, p);
        make_contact(*body, p);
    }
    const double depth = body->contact ? body->contact->deepest(p.around.colliders, body->state.x, p.threads) : 0;
    if (depth > 0.01 * body->model.node_length)
        p.warn(name_of(*body, p.bodies.size()) + " begins " + format_number(depth) + " m inside of a collider");
    if (bodies_meet(p.settings.integrator)) {
        let_overlapping_pass(p, *body);
        if (p.bodies.size() == 1) warn_of_open_contact(p, *p.bodies[0], 0);
        if (!p.bodies.empty()) warn_of_open_contact(p, *body, p.bodies.size());
    } else if (!p.bodies.empty()) {
        p.warn(
            "bodies meet each other only with the integrators implicit-euler and bdf2; here they pass through each "
            "other");
    }
    const BodyEnergy energy = body_energy(*body, p.around, p.threads);
    info.energy_at_start = energy.total();
    info.gravity_at_start = energy.gravitational;
    auto free = std::find_if(p.slots.begin(), p.slots.end(), [](const Parts::Slot& s) { return !s.alive; });
    if (free == p.slots.end()) free = p.slots.insert(p.slots.end(), Parts::Slot{});
    free->alive = true;
    free->body = p.bodies.size();
    info.id = {static_cast<std::uint32_t>(free - p.slots.begin()), free->generation};
    p.bodies.push_back(std::move(body));
    p.infos.push_back(std::move(info));
    p.ledger();
    return p.infos.back().id;
}

void World::remove_body(BodyId id) {
    Parts& p = *parts_;
    const std::size_t index = p.index_of(id);
    p.bodies.erase(p.bodies.begin() + static_cast<std::ptrdiff_t>(index));
    p.infos.erase(p.infos.begin() + static_cast<std::ptrdiff_t>(index));
    for (const auto& body : p.bodies) forget_number(*body, static_cast<std::uint32_t>(index));
    p.slots[id.index].alive = false;
    ++p.slots[id.index].generation;
    for (Parts::Slot& slot : p.slots)
        if (slot.alive && slot.body > index) --slot.body;
}

std::size_t World::add_collider(const Plane& plane) { return phyxel::add_collider(*parts_, plane); }

std::size_t World::add_collider(const Sphere& sphere) { return phyxel::add_collider(*parts_, sphere); }

std::size_t World::add_collider(const Box& box) { return phyxel::add_collider(*parts_, box); }

std::size_t World::add_fix(BodyId id, const Fix& fix) {
    Parts& p = *parts_;
    check_box(fix.box, "fix");
    if (!(fix.x || fix.y || fix.z)) throw Error("fix directions: expected at least one of x, y, z");
    if (!is_finite(fix.axis) || norm(fix.axis) == 0) throw Error("fix axis: expected a vector of any length but zero");
    if (!is_finite(fix.center)) throw Error("fix center: expected finite coordinates [m]");
    for (std::size_t k = 0; k < fix.path.size(); ++k) {
        const GripKey& key = fix.path[k];
        if (!std::isfinite(key.time) || !is_finite(key.displacement) || !std::isfinite(key.degrees))
            throw Error("fix path: expected finite times, displacements and degrees");
        if (k > 0 && !(key.time > fix.path[k - 1].time)) throw Error("fix path: the times of its keys must rise");
    }
    DynamicBody& body = p.body(id);
    body.forget_solver();
    p.fixes.push_back({id, body.constraints.add(body.model, body.mesh, fix, p.threads)});
    return p.fixes.size() - 1;
}

std::size_t World::add_load(BodyId id, const Load& load) {
    Parts& p = *parts_;
    check_box(load.box, "load");
    if (load.force.has_value() + load.traction.has_value() + load.pressure.has_value() != 1)
        throw Error("load: expected exactly one of force, traction, pressure");
    if (load.force && !is_finite(*load.force)) throw Error("load force: expected finite numbers [N]");
    if (load.traction && !is_finite(*load.traction)) throw Error("load traction: expected finite numbers [Pa]");
    if (load.pressure && !std::isfinite(*load.pressure)) throw Error("load pressure: expected a finite number [Pa]");
    if (!(load.ramp >= 0) || !std::isfinite(load.ramp))
        throw Error("load ramp: found " + format_number(load.ramp) + ", expected a finite number of at least 0 [s]");
    DynamicBody& body = p.body(id);
    body.loads.emplace_back(body.model, body.mesh, load, p.threads);
    return body.loads.size() - 1;
}

std::size_t World::add_probe(BodyId id, const Vec3& rest_point) {
    Parts& p = *parts_;
    const DynamicBody& body = p.body(id);
    const auto cell = find_cell_of_point(body, rest_point);
    if (!cell)
        throw Error("probe at " + format_point(rest_point) + " lies outside of its body. Move it inside (rest space)");
    const Vec3 position = body.model.sampling.frame.to_lattice(rest_point);
    p.probes.push_back({id, rest_point,
                        embed(body.model.sampling, body.model.approximation, std::span(&position, 1),
                              std::span(&*cell, 1), Gradients::no, p.threads)});
    return p.probes.size() - 1;
}

StepReport World::step() { return advance(parts_->settings.time_step); }

StepReport World::advance(double seconds) {
    Parts& p = *parts_;
    StepReport total;
    double left = seconds;
    while (left > 1e-12 * seconds && total.status == StepStatus::ok) {
        // The last step is as short as it must be; one that would leave a sliver takes it along.
        const double dt = left < p.settings.time_step * (1 + 1e-9) ? left : p.settings.time_step;
        const StepReport one = phyxel::advance(p.bodies, p.around, p.settings.integrator, p.time, dt, p.threads);
        total.status = one.status;
        total.message = one.message;
        total.substeps += one.substeps;
        total.retries += one.retries;
        total.substep = one.substep;
        total.contacts = one.contacts;
        total.advanced += one.advanced;
        total.newton_iterations += one.newton_iterations;
        total.newton_worst = std::max(total.newton_worst, one.newton_worst);
        total.linear_iterations += one.linear_iterations;
        total.linear_worst = std::max(total.linear_worst, one.linear_worst);
        p.time += one.advanced;
        if (one.advanced > 0) p.measured_seconds = one.advanced;
        if (one.retries > 0) p.warn("steps that were thrown away and cut into smaller ones", one.retries);
        if (is_explicit(p.settings.integrator)) p.ledger();
        else p.note_energy();
        left -= dt;
    }
    for (auto& body : p.bodies) body->surface->update(body->state.x, p.threads);
    return total;
}

void World::set_gravity(const Vec3& gravity) {
    Parts& p = *parts_;
    if (!is_finite(gravity)) throw Error("gravity: expected finite numbers [m/s^2]");
    // Potential energy counts from where each body is: changing the field is no work.
    std::vector<double> before;
    for (auto& body : p.bodies) before.push_back(body_energy(*body, p.around, p.threads).gravitational);
    p.around.gravity = p.settings.gravity = gravity;
    for (std::size_t i = 0; i < p.bodies.size(); ++i) {
        const double change = body_energy(*p.bodies[i], p.around, p.threads).gravitational - before[i];
        p.infos[i].energy_at_start += change;
        p.infos[i].gravity_at_start += change;
    }
}

void World::set_velocity(BodyId id, const Vec3& velocity) {
    Parts& p = *parts_;
    if (!(norm(velocity) <= fastest))
        throw Error("velocity: found " + format_number(norm(velocity)) + ", expected at most the speed of light [m/s]");
    DynamicBody& body = p.body(id);
    const double before = kinetic_energy(body, p.threads);
    std::fill(body.state.v.begin(), body.state.v.end(), velocity);
    body.history = {};
    body.step_energy.reset();
    body.exchanged.external += kinetic_energy(body, p.threads) - before;
}

void World::set_material(BodyId id, const Material& material, std::optional<std::size_t> region) {
    Parts& p = *parts_;
    validate(material);
    check_tangent(p.settings.solver, material);
    DynamicBody& body = p.body(id);
    const std::size_t which = region ? *region + 1 : 0,
                      regions = std::max<std::size_t>(body.model.mixture.materials.size(), 1) - 1;
    if (region && *region >= regions)
        throw Error("region " + std::to_string(*region) + ": this body has " + std::to_string(regions) +
                    " regions, counted from 0");
    const Material& now = which == 0 ? body.model.settings : body.model.mixture.materials[which];
    if (material.density != now.density)
        throw Error("material density: found " + format_number(material.density) + ", expected the one it has, " +
                    format_number(now.density) + " kg/m^3; its mass does not change");
    refuse_blended_laws(body.model.mixture, which, material);
    const double before = body_energy(body, p.around, p.threads).total();
    phyxel::set_material(body.model, material, which);
    body.forget_solver();
    find_rest_step(body, p);
    prepare_contact(body, p);
    body.exchanged.external += body_energy(body, p.around, p.threads).total() - before;
}

double World::time() const { return parts_->time; }

double World::stable_substep() const {
    double limit = parts_->settings.time_step;
    for (const auto& body : parts_->bodies) limit = std::min(limit, body->step_limit);
    return limit;
}

std::span<const Vec3> World::rest_positions(BodyId id) const { return parts_->body(id).model.rest; }
std::span<const Vec3> World::positions(BodyId id) const { return parts_->body(id).state.x; }
std::span<const Vec3> World::velocities(BodyId id) const { return parts_->body(id).state.v; }
std::span<const double> World::masses(BodyId id) const { return parts_->body(id).model.mass; }
const Surface& World::surface(BodyId id) const { return *parts_->body(id).surface; }
const MeshReport& World::mesh_report(BodyId id) const { return parts_->infos[parts_->index_of(id)].mesh_report; }

Reaction World::reaction(std::size_t fix) const {
    if (fix >= parts_->fixes.size()) throw Error("there is no fix number " + std::to_string(fix));
    const Parts::FixName& name = parts_->fixes[fix];
    return parts_->body(name.body).constraints.reaction(name.number, parts_->measured_seconds);
}

ProbeReading World::probe(std::size_t probe) const {
    if (probe >= parts_->probes.size()) throw Error("there is no probe number " + std::to_string(probe));
    const Parts::Probe& p = parts_->probes[probe];
    return {p.rest, p.point.position(0, parts_->body(p.body).state.x)};
}

std::vector<Warning> World::warnings() const {
    std::vector<Warning> list;
    for (const auto& [message, count] : parts_->warnings) list.push_back({message, count});
    return list;
}

std::uint64_t World::state_hash() const {
    Hasher hasher;
    hasher.add_value(parts_->time);
    for (const auto& body : parts_->bodies) {
        hasher.add_values(std::span<const Vec3>(body->state.x));
        hasher.add_values(std::span<const Vec3>(body->state.v));
    }
    return hasher.value();
}

}  // namespace phyxel
