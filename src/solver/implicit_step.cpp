#include "solver/implicit_step.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh_topology.h"
#include "solver/nodal_vectors.h"
#include "solver/step.h"

namespace phyxel {
namespace {

constexpr double least_way = 1e-6;  ///< [spacings] of all nodes, below which nothing moves
constexpr int most_iterations = 40, most_newton = 60;
constexpr int most_restarts = 4;    ///< of L-BFGS, where something touches
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

/// Tolerances below which single precision's rounding is in the way: a hundredth of a millimetre for a beam that falls
/// by a metre. At 1e-6 L-BFGS would end in it, and the step would fail.
constexpr double least_single_tolerance = 1e-5;

SolverPrecision precision_of(const SolverSettings& settings) {
    const bool fine = settings.tolerance > 0 && settings.tolerance < least_single_tolerance;
    return fine ? SolverPrecision::full : settings.precision;
}

/// Elastic and stabilization energy [J], in the precision of the step's forces: rounding does not add up over steps.
double stored_energy(DynamicBody& b, const Threads& threads) {
    if (b.fast_forces) return b.fast_forces->energy(b.model, b.state.x, threads);
    return elastic_energy(b.model, b.state.x, b.work, threads) +
           stabilization_energy(b.model, b.state.x, b.work, threads);
}

/// Kinetic and all stored energy [J].
double step_energy(const DynamicBody& b, double stored, const Surroundings& around, const Threads& threads) {
    const double contact = b.contact ? b.contact->energy(around.colliders, b.state.x, threads) : 0;
    return kinetic_energy(b, threads) + b.penalty_energy + b.body_contact_energy + contact + stored;
}

/// How much of a body's last change of velocity is likely to come again: three fifths of its correlation with the one
/// before, none where they differ, as around rest.
double trend(const DynamicBody& b, std::span<const Vec3> v, double dt, const Threads& threads) {
    constexpr double share = 0.6;
    const History& last = b.history;
    if (!(last.dt > 0)) return 0;
    const auto product = [&](auto&& first, auto&& second) {
        return threads.sum(v.size(), node_chunk,
                           [&](std::size_t i) { return b.model.mass[i] * dot(first(i), second(i)); });
    };
    const auto now = [&](std::size_t i) { return (v[i] - b.state.v[i]) / dt; };
    const auto before = [&](std::size_t i) { return (b.state.v[i] - last.v[i]) / last.dt; };
    const double size = product(before, before);
    return size > 0 ? std::clamp(share * product(now, before) / size, 0.0, 1.0) : 0;
}

/// Where a node would be after dt.
Vec3 predicted(const DynamicBody& b, std::size_t i, double dt) {
    const Vec3 straight = b.state.x[i] + dt * b.state.v[i];
    if (b.history.trend == 0) return straight;
    return straight + b.history.trend * dt * dt / b.history.dt * (b.state.v[i] - b.history.v[i]);
}

/// One body's part of a step: what is minimized, where from, and what is booked in the end.
class BodyStep {
public:
    BodyStep(DynamicBody& body, const Surroundings& around, ImplicitScheme scheme, double start, double dt,
             const Threads& threads);

    IncrementalPotential potential;
    WarpedPreconditioner* preconditioner;
    /// How far the body would go by itself, in the metric of the potential: what errors are measured against.
    double way = 0;

    /// Takes the end of the step, and books what it did: the work of its forces, and what it lost by itself, which is
    /// the work of inertia and of stored energy at the end of the step less what they hold now. Needs the body's
    /// `step_energy` of before. `moves`: the first guess was not good enough.
    void finish(std::span<const Vec3> x, const IncrementalPotential::Forces& forces, bool moves);

private:
    DynamicBody& b_;
    const Surroundings& around_;
    double start_, dt_;
    Difference d_;
    std::vector<Vec3> past_x_, past_v_;
    const Threads& threads_;
};

BodyStep::BodyStep(DynamicBody& b, const Surroundings& around, ImplicitScheme scheme, double start, double dt,
                   const Threads& threads)
    : potential(b, around, precision_of(around.solver), threads),
      b_(b),
      around_(around),
      start_(start),
      dt_(dt),
      d_(difference(b.history, scheme, dt)),
      past_x_(past(d_, b.state.x, b.history.x)),
      past_v_(past(d_, b.state.v, b.history.v)),
      threads_(threads) {
    const Model& m = b.model;
    const std::size_t n = m.rest.size();
    set_contact_stiffness(b, dt);
    potential.inertia = (d_.a0 / dt + around.mass_damping) * d_.a0 / dt;
    potential.target.resize(n);
    threads.for_each(n, node_chunk, [&](std::size_t i) {
        potential.target[i] = past_x_[i] / d_.a0 + past_v_[i] / (dt * potential.inertia);
        potential.velocity_offset[i] = past_x_[i] / dt;
    });
    potential.velocity_share = d_.a0 / dt;
    potential.time = potential.load_time = start + dt;
    potential.start = b.state.x;
    preconditioner = &b.prepare_preconditioner(1 + around.stiffness_damping * d_.a0 / dt, potential.inertia, threads);

    std::vector<Vec3> loads(n);
    for (const SurfaceLoad& load : b.loads) load.add(start + dt, b.state.x, loads);
    const double free_way = std::sqrt(threads.sum(n, node_chunk, [&](std::size_t i) {
        const Vec3 u = dt * b.state.v[i] + dt * dt * (around.gravity + m.inverse_mass[i] * loads[i]);
        return m.mass[i] * norm_squared(u);
    }));
    way = std::max(free_way, least_way * m.node_length * std::sqrt(m.total_mass)) * std::sqrt(potential.inertia);
}

void BodyStep::finish(std::span<const Vec3> x, const IncrementalPotential::Forces& forces, bool moves) {
    const Model& m = b_.model;
    const std::size_t n = m.rest.size();
    const double before = *b_.step_energy;
    std::vector<Vec3> v(n), inertial(n);
    threads_.for_each(n, node_chunk, [&](std::size_t i) {
        v[i] = (d_.a0 * x[i] - past_x_[i]) / dt_;
        inertial[i] = m.mass[i] / dt_ * (d_.a0 * v[i] - past_v_[i]);
    });
    const auto work_of = [&](auto&& force) {
        return threads_.sum(n, node_chunk, [&](std::size_t i) { return dot(force(i), x[i] - b_.state.x[i]); });
    };
    const Constraints::GripWork grips = b_.constraints.measure(start_, start_ + dt_, x, forces.sum);
    b_.exchanged.external += work_of([&](std::size_t i) { return forces.loads[i]; }) + grips.nodes + grips.patches;
    b_.exchanged.damping -=
        work_of([&](std::size_t i) { return forces.viscous[i] - around_.mass_damping * m.mass[i] * v[i]; });
    b_.exchanged.friction -= work_of([&](std::size_t i) { return forces.friction[i]; });
    b_.exchanged.numerical +=
        work_of([&](std::size_t i) { return inertial[i] - forces.conservative[i]; }) + grips.patches;

    if (b_.contact) b_.sticks = b_.contact->sticks(b_.rubs, x);
    // Where one correction is enough, more momentum would only keep it swinging within the tolerance.
    const double next = moves ? trend(b_, v, dt_, threads_) : 0;
    b_.history = {std::move(b_.state.x), std::move(b_.state.v), dt_, next};
    b_.state = {std::vector<Vec3>(x.begin(), x.end()), std::move(v)};
    b_.penalty_energy = b_.constraints.penalty_energy(start_ + dt_, b_.state.x);
    b_.step_energy = step_energy(b_, forces.stored, around_, threads_);
    b_.exchanged.numerical -= *b_.step_energy - before;
}

/// Newton's method once more, from where the bodies were, after it failed from a guess.
SolveReport solve_from_start(CoupledBodies& bodies, const std::vector<Vec3>& start, std::vector<Vec3>& x,
                             const SolveTolerance& bound, SolveReport report) {
    x = start;
    bodies.place_held(x);
    report.add(newton(bodies, x, bound, NewtonSteps::guarded, most_newton));
    return report;
}

double furthest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    double way = 0;
    for (std::size_t i = 0; i < from.size(); ++i) way = std::max(way, norm(to[i] - from[i]));
    return way;
}

SolveReport solve(CoupledBodies& bodies, SolverMethod method, const std::vector<Vec3>& start, std::vector<Vec3>& x,
                  const SolveTolerance& bound) {
    if (method == SolverMethod::single_newton) {
        x = start;
        SolveReport report = newton(bodies, x, bound, NewtonSteps::full, 1);
        report.converged = std::isfinite(report.residual);
        return report;
    }
    if (method == SolverMethod::newton) {
        const SolveReport report = newton(bodies, x, bound, NewtonSteps::guarded, most_newton);
        if (report.converged) return report;
        return solve_from_start(bodies, start, x, bound, report);
    }

    // Where contact opens or closes on the way, the preconditioner is told, and L-BFGS begins anew.
    SolveReport report = l_bfgs(bodies, x, bound, most_iterations);
    for (int k = 0; k < most_restarts && !report.converged; ++k) {
        if (!bodies.support(x)) break;
        report.add(l_bfgs(bodies, x, bound, most_iterations));
    }
    if (report.converged) return report;
    // Newton's method from where L-BFGS got, else from where the bodies were.
    report.add(newton(bodies, x, bound, NewtonSteps::guarded, most_newton));
    if (report.converged) return report;
    return solve_from_start(bodies, start, x, bound, report);
}

}  // namespace

SolveReport implicit_step(std::span<const std::unique_ptr<DynamicBody>> all, std::span<const std::uint32_t> members,
                          const Surroundings& around, ImplicitScheme scheme, double start, double dt,
                          const Threads& threads) {
    // The potential of the step, its contact, and a first guess.
    std::vector<std::unique_ptr<BodyStep>> steps;
    std::vector<CoupledBodies::Part> parts;
    std::vector<BodyContact::Side> sides;
    std::vector<Vec3> begin, x;
    for (std::uint32_t number : members) {
        DynamicBody& b = *all[number];
        steps.push_back(std::make_unique<BodyStep>(b, around, scheme, start, dt, threads));
        parts.push_back({&steps.back()->potential, steps.back()->preconditioner, steps.back()->way});
        if (members.size() > 1)
            sides.push_back({&*b.contact, number, begin.size(), b.state.x.size(), b.friction, b.model.sampling.spacing,
                             b.body_sticks, b.apart});
        begin.insert(begin.end(), b.state.x.begin(), b.state.x.end());
        for (std::size_t i = 0; i < b.state.x.size(); ++i) x.push_back(predicted(b, i, dt));
    }
    BodyContact contact(std::move(sides));
    CoupledBodies bodies(std::move(parts), members.size() > 1 ? &contact : nullptr, threads);
    bodies.place_held(x);
    bodies.turn(x);

    const double tolerance = around.solver.tolerance > 0 ? around.solver.tolerance : default_step_tolerance;
    const bool single = around.solver.method == SolverMethod::single_newton;
    SolveReport report;
    bool touch = false;
    for (int pass = 0; pass < friction_passes && !(single && pass > 0); ++pass) {
        for (std::size_t p = 0; p < steps.size(); ++p) steps[p]->potential.lag_friction(bodies.of(p, x));
        if (members.size() > 1) contact.find(x, begin, 2 * furthest(begin, x), threads);
        const auto rubs = [](const auto& step) { return !step->potential.body.rubs.empty(); };
        const bool touched = touch;
        touch = !contact.empty() || std::any_of(steps.begin(), steps.end(), rubs);
        if (pass > 0 && !touch && !touched) break;
        bodies.support(x);
        report.add(solve(bodies, around.solver.method, begin, x, {0, tolerance, single ? 1e-8 : 1e-2}));
        if (!report.converged) return report;
    }

    std::vector<Vec3> push(x.size()), friction(x.size());
    contact.add_forces(x, push);
    contact.add_friction_forces(x, friction);
    for (std::size_t p = 0; p < steps.size(); ++p) {
        DynamicBody& b = steps[p]->potential.body;
        IncrementalPotential::Forces forces = steps[p]->potential.forces(bodies.of(p, x));
        const std::span<const Vec3> own_push = bodies.of(p, push), own_friction = bodies.of(p, friction);
        for (std::size_t i = 0; i < own_push.size() && members.size() > 1; ++i) {
            forces.conservative[i] += own_push[i];
            forces.friction[i] += own_friction[i];
            forces.sum[i] += own_push[i] + own_friction[i];
        }
        b.body_sticks = contact.sticks(p, x);
        b.body_touches = contact.touching(p, x);
        if (!b.step_energy) b.step_energy = step_energy(b, stored_energy(b, threads), around, threads);
        b.body_contact_energy = contact.energy(p, x);
        steps[p]->finish(bodies.of(p, x), forces, report.newton_iterations > 1);
    }
    return report;
}

std::vector<std::vector<std::uint32_t>> groups_that_may_touch(std::span<const std::unique_ptr<DynamicBody>> all,
                                                              const Surroundings& around, double end, double dt) {
    std::vector<Bounds> boxes(all.size());
    if (all.size() > 1)
        for (std::size_t i = 0; i < all.size(); ++i) {
            const DynamicBody& b = *all[i];
            std::vector<Vec3> next = b.state.x;
            for (std::size_t n = 0; n < next.size(); ++n) next[n] += dt * b.state.v[n] + dt * dt * around.gravity;
            b.constraints.place_held(end, next);
            boxes[i] = b.contact->reach(b.state.x);
            boxes[i].add(b.contact->reach(next));
        }
    DisjointSets sets(all.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        for (std::uint32_t j = i + 1; j < all.size(); ++j)
            if (boxes[i].overlaps(boxes[j])) sets.unite(i, j);
    std::vector<std::vector<std::uint32_t>> groups(all.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) groups[sets.find(i)].push_back(i);
    std::erase_if(groups, [](const auto& group) { return group.empty(); });
    return groups;
}

}  // namespace phyxel
