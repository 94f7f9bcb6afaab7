#include "solver/incremental_potential.h"

#include <algorithm>
#include <cmath>

#include "solver/nodal_vectors.h"

namespace phyxel {
namespace {

constexpr double contact_share = 10;  ///< stiffness of contact over 1 / (tau^2 w)

}  // namespace

IncrementalPotential::IncrementalPotential(DynamicBody& b, const Surroundings& surroundings, SolverPrecision precision,
                                           const Threads& t)
    : body(b),
      around(surroundings),
      threads(t),
      fast_(precision == SolverPrecision::single ? b.prepare_fast_forces(t) : nullptr),
      free_(b.constraints.free_components(b.model.rest.size())) {
    velocity_.resize(free_.size());
    velocity_offset.resize(free_.size());
}

void IncrementalPotential::lag_friction(std::span<const Vec3> x) {
    body.rubs.clear();
    if (!body.contact || around.colliders.empty()) return;
    std::vector<Vec3> ignored(free_.size());
    body.touches = body.contact->add_forces(around.colliders, x, threads, ignored);
    body.rubs = body.contact->rubs(around.colliders, body.touches, body.sticks, start);
}

std::vector<Mat3> IncrementalPotential::supports(std::span<const Vec3> x) {
    if (!body.contact || around.colliders.empty()) return {};
    std::vector<Vec3> ignored(free_.size());
    body.touches = body.contact->add_forces(around.colliders, x, threads, ignored);
    if (body.touches.empty()) return {};
    std::vector<Mat3> blocks(free_.size());
    body.contact->add_lumped(body.touches, body.rubs, x, blocks);
    return blocks;
}

void IncrementalPotential::damped_forces(std::span<const Vec3> x, std::span<Vec3> f) {
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { velocity_[i] = velocity_share * x[i] - velocity_offset[i]; });
    if (fast_) fast_->damped_forces(body.model, x, velocity_, stiffness_damping(), threads, f);
    else internal_forces(body.model, x, velocity_, stiffness_damping(), body.work, threads, f);
}

void IncrementalPotential::add_contact(std::span<const Vec3> x, std::span<Vec3> f, std::span<Vec3> friction) {
    body.touches.clear();
    if (!body.contact || around.colliders.empty()) return;
    body.touches = body.contact->add_forces(around.colliders, x, threads, f);
    body.contact->add_friction_forces(body.rubs, x, friction);
}

void IncrementalPotential::gradient(std::span<const Vec3> x, std::span<Vec3> g) {
    const Model& m = body.model;
    if (stiffness_damping() > 0) damped_forces(x, g);
    else if (fast_) fast_->forces(m, x, threads, g);
    else internal_forces(m, x, {}, 0, body.work, threads, g);
    loads_.assign(x.size(), {});
    for (const SurfaceLoad& load : body.loads) load.add(load_time, x, loads_);
    threads.for_each(x.size(), node_chunk, [&](std::size_t i) {
        g[i] += load_share * (loads_[i] + m.mass[i] * around.gravity);
        if (inertia > 0) g[i] -= inertia * m.mass[i] * (x[i] - target[i]);
    });
    body.constraints.add_penalty_forces(time, x, g);
    add_contact(x, g, g);
    threads.for_each(x.size(), node_chunk, [&](std::size_t i) { g[i] = times(free_[i], -g[i]); });
}

IncrementalPotential::Forces IncrementalPotential::forces(std::span<const Vec3> x) {
    const Model& m = body.model;
    const std::size_t n = x.size();
    Forces f;
    for (auto* part : {&f.conservative, &f.viscous, &f.friction, &f.loads, &f.sum}) part->assign(n, {});
    if (fast_) {
        f.stored = fast_->forces(m, x, threads, f.conservative);
    } else {
        internal_forces(m, x, {}, 0, body.work, threads, f.conservative);
        f.stored = elastic_energy(m, x, body.work, threads) + stabilization_energy(m, x, body.work, threads);
    }
    if (stiffness_damping() > 0) {
        damped_forces(x, f.viscous);
        add_scaled(f.viscous, -1.0, f.conservative, threads);
    }
    body.constraints.add_penalty_forces(time, x, f.conservative);
    add_contact(x, f.conservative, f.friction);
    for (const SurfaceLoad& load : body.loads) load.add(load_time, x, f.loads);
    threads.for_each(n, node_chunk, [&](std::size_t i) {
        f.loads[i] *= load_share;
        f.sum[i] =
            f.conservative[i] + f.viscous[i] + f.friction[i] + f.loads[i] + load_share * m.mass[i] * around.gravity;
        if (inertia > 0) f.sum[i] -= inertia * m.mass[i] * (x[i] - target[i]);
    });
    return f;
}

void IncrementalPotential::action(std::span<const Vec3> x, std::span<const Vec3> d, std::span<Vec3> out) {
    const Model& m = body.model;
    stiffness_action(m, x, d, body.work, threads, out, around.solver.tangent);
    // Viscous forces: their change with the rate of strain, taken as that of the elastic ones.
    const double stiffness = 1 + around.stiffness_damping * velocity_share;
    threads.for_each(free_.size(), node_chunk,
                     [&](std::size_t i) { out[i] = stiffness * out[i] + inertia * m.mass[i] * d[i]; });
    body.constraints.add_penalty_action(d, out);
    add_contact_action(x, d, out);
    threads.for_each(out.size(), node_chunk, [&](std::size_t i) { out[i] = times(free_[i], out[i]); });
}

void IncrementalPotential::add_contact_action(std::span<const Vec3> x, std::span<const Vec3> d,
                                              std::span<Vec3> out) const {
    if (!body.touches.empty()) body.contact->add_action(body.touches, d, out);
    if (!body.rubs.empty()) body.contact->add_friction_action(body.rubs, x, d, out);
}

void IncrementalPotential::add_free(double s, std::span<const Vec3> f, std::span<Vec3> a) const {
    threads.for_each(a.size(), node_chunk, [&](std::size_t i) { a[i] += s * times(free_[i], f[i]); });
}

void set_contact_stiffness(DynamicBody& b, double dt) {
    if (!b.contact) return;
    const Model& m = b.model;
    const double density = m.total_mass / m.sampling.clipped_volume;
    const double crossing = m.node_length * std::sqrt(density / m.largest_modulus);
    b.contact->set_stiffness(contact_share, std::min(dt, crossing));
}

double IncrementalPotential::external_force(std::span<const Vec3> x) {
    const Model& m = body.model;
    std::vector<Vec3> f(free_.size());
    for (const SurfaceLoad& load : body.loads) load.add(load_time, x, f);
    threads.for_each(f.size(), node_chunk,
                     [&](std::size_t i) { f[i] = load_share * (f[i] + m.mass[i] * around.gravity); });
    return std::sqrt(inner(f, f, threads));
}

}  // namespace phyxel
