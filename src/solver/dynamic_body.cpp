#include "solver/dynamic_body.h"

#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

constexpr std::size_t chunk = 1024;

double work_of(std::span<const Vec3> force, const DynamicBody& body, const Threads& threads) {
    return threads.sum(force.size(), chunk,
                       [&](std::size_t i) { return 0.5 * dot(force[i], body.previous[i] + body.state.v[i]); });
}

std::unique_ptr<FastForces> make_fast_forces(const Model& model, const Threads& threads) {
    if (!model.nodal.kappa.empty()) return nullptr;
    CellBlocks cells(model, threads);
    if (!FastForces::apply_to(model, cells)) return nullptr;
    return std::make_unique<FastForces>(model, std::move(cells));
}

/// The model with lambda no larger than at a Poisson's ratio of 0.45, every point by itself.
Model soften(const Model& model) {
    constexpr double ratio = 0.45;
    const auto soften_point = [](MaterialPoint& point) {
        point.lame.lambda = std::min(point.lame.lambda, 2 * point.lame.mu * ratio / (1 - 2 * ratio));
    };
    Model softened = model;
    softened.dilatation = {};
    soften_point(softened.material);
    for (MaterialPoint& point : softened.point_materials) soften_point(point);
    return softened;
}

}  // namespace

FastForces* DynamicBody::prepare_fast_forces(const Threads& threads) {
    if (!fast_forces) fast_forces = make_fast_forces(model, threads);
    return fast_forces.get();
}

WarpedPreconditioner& DynamicBody::prepare_preconditioner(double stiffness, double inertia, const Threads& threads) {
    if (!preconditioner && !model.dilatation.empty()) {
        softened = std::make_unique<Model>(soften(model));
        preconditioner = std::make_unique<WarpedPreconditioner>(*softened, constraints, threads);
    }
    if (!preconditioner) preconditioner = std::make_unique<WarpedPreconditioner>(model, constraints, threads);
    preconditioner->set_weights(stiffness, inertia, threads);
    return *preconditioner;
}

std::string name_of(const DynamicBody& body, std::size_t number) {
    return body.name.empty() ? "body " + std::to_string(number) : "body \"" + body.name + '"';
}

void evaluate_forces(DynamicBody& b, const Surroundings& around, double time, const Threads& threads) {
    const std::size_t n = b.model.rest.size();
    b.force.resize(n);
    b.viscous_power =
        internal_forces(b.model, b.state.x, b.state.v, around.stiffness_damping, b.work, threads, b.force);
    threads.for_each(n, chunk, [&](std::size_t i) { b.force[i] += b.model.mass[i] * around.gravity; });
    if (!b.loads.empty()) {
        b.load_force.assign(n, {});
        for (const SurfaceLoad& load : b.loads) load.add(time, b.state.x, b.load_force);
        threads.for_each(n, chunk, [&](std::size_t i) { b.force[i] += b.load_force[i]; });
    }
    b.touches.clear();
    if (b.contact && !around.colliders.empty())
        b.touches = b.contact->add_forces(around.colliders, b.state.x, threads, b.force);
}

void kick(DynamicBody& b, const Surroundings& around, double dt, double drift_length, double time,
          const Threads& threads) {
    const std::size_t n = b.model.rest.size();
    b.previous = b.state.v;
    // Exact for a constant force: v' = e v + (1 - e)/alpha f/m, e = exp(-alpha dt).
    const double alpha = around.mass_damping;
    const double keep = std::exp(-alpha * dt), length = alpha > 0 ? -std::expm1(-alpha * dt) / alpha : dt;
    threads.for_each(n, chunk, [&](std::size_t i) {
        b.state.v[i] = keep * b.previous[i] + length * b.model.inverse_mass[i] * b.force[i];
    });
    if (!b.touches.empty()) {
        b.friction_impulse.assign(n, {});
        b.contact->add_friction(around.colliders, b.touches, length, b.state.v, b.friction_impulse);
    }
    if (!b.constraints.empty()) {
        b.impulse.assign(n, {});
        b.constraints.project(time, drift_length, b.state.x, b.state.v, b.impulse, length / dt);
        b.exchanged.external += work_of(b.impulse, b, threads);
    }

    // An impulse j changes the kinetic energy by j (v + v')/2.
    if (!b.loads.empty()) b.exchanged.external += dt * work_of(b.load_force, b, threads);
    if (!b.touches.empty()) b.exchanged.friction -= work_of(b.friction_impulse, b, threads);
    b.exchanged.damping += dt * b.viscous_power;
    if (alpha > 0) {
        const bool held = !b.constraints.empty();
        b.exchanged.damping += threads.sum(n, chunk, [&](std::size_t i) {
            Vec3 lost = b.model.mass[i] * (1 - keep) * b.previous[i] + (dt - length) * b.force[i];
            if (held) lost += (1 - length / dt) * b.impulse[i];
            return 0.5 * dot(lost, b.previous[i] + b.state.v[i]);
        });
    }
}

void drift(DynamicBody& b, double dt, const Threads& threads) {
    threads.for_each(b.state.x.size(), chunk, [&](std::size_t i) { b.state.x[i] += dt * b.state.v[i]; });
}

double kinetic_energy(const DynamicBody& b, const Threads& threads) {
    return 0.5 * threads.sum(b.state.v.size(), chunk,
                             [&](std::size_t i) { return b.model.mass[i] * norm_squared(b.state.v[i]); });
}

}  // namespace phyxel
