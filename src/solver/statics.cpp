#include "solver/statics.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.h"
#include "solver/nodal_vectors.h"
#include "solver/step.h"

namespace phyxel {
namespace {

constexpr int most_full = 25, most_guarded = 100;
constexpr double shortest_load_step = 1.0 / 256;

/// Whether the fixes leave the body no rigid motion: the smallest eigenvalue of their constraints on the six of them.
bool is_held(const DynamicBody& b) {
    const Model& m = b.model;
    Vec3 center{};
    for (const Vec3& X : m.rest) center += X / double(m.rest.size());
    double size = 0;
    for (const Vec3& X : m.rest) size = std::max(size, norm(X - center));
    Eigen::Matrix<double, 6, 6> G = Eigen::Matrix<double, 6, 6>::Zero();
    const auto add = [&](const Vec3& X, const Vec3& directions) {
        const Vec3 r = (X - center) / size;
        const Mat3 turn = {{{0, r.z, -r.y}, {-r.z, 0, r.x}, {r.y, -r.x, 0}}};
        for (std::size_t d = 0; d < 3; ++d) {
            if (directions[d] == 0) continue;
            Eigen::Matrix<double, 6, 1> row = Eigen::Matrix<double, 6, 1>::Zero();
            row[static_cast<Eigen::Index>(d)] = 1;
            for (std::size_t k = 0; k < 3; ++k) row[static_cast<Eigen::Index>(3 + k)] = turn(d, k);
            G += row * row.transpose();
        }
    };
    const std::vector<Vec3> free = b.constraints.free_components(m.rest.size());
    for (std::size_t i = 0; i < free.size(); ++i) add(m.rest[i], Vec3{1, 1, 1} - free[i]);
    for (const Constraints::Patch& patch : b.constraints.patches()) {
        Vec3 X{};
        for (std::size_t i = 0; i < patch.node.size(); ++i) X += patch.coefficient[i] * m.rest[patch.node[i]];
        add(X, patch.stiffness);
    }
    const double largest = G.trace();
    return largest > 0 &&
           Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(G).eigenvalues()[0] > 1e-6 * largest;
}

/// Largest lambda + 2 mu [Pa]: what rounding in the strain is multiplied with.
double stiffest_modulus(const Model& m) {
    double largest = m.material.lame.lambda + 2 * m.material.lame.mu;
    for (const MaterialPoint& point : m.point_materials)
        largest = std::max(largest, point.lame.lambda + 2 * point.lame.mu);
    return largest;
}

/// One load step. `x` is left at the solution, or as it was.
SolveReport solve(IncrementalPotential& potential, CoupledBodies& alone, std::vector<Vec3>& x) {
    // What residuals are measured against: loads, and the forces that moving grips bring about.
    const Threads& threads = potential.threads;
    std::vector<Vec3> held = x, pull(x.size());
    potential.body.constraints.place_held(potential.time, held);
    for (std::size_t i = 0; i < x.size(); ++i) held[i] -= x[i];
    const std::vector<Vec3> sum = potential.forces(x).sum;
    potential.action(x, held, pull);
    double scale = std::max(potential.external_force(x), std::sqrt(inner(pull, pull, threads)));
    scale = std::max(scale, std::sqrt(inner(sum, sum, threads)));
    // A body with nothing acting on it is in equilibrium up to rounding.
    const Model& m = potential.body.model;
    scale = std::max(scale, 1e-9 * m.largest_modulus * m.node_length * m.node_length);
    double reach = 0;
    for (const Vec3& X : x) reach = std::max(reach, norm(X - x.front()));
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * stiffest_modulus(m) * m.node_length * reach;
    const SolverSettings& settings = potential.around.solver;
    const double share = settings.tolerance > 0 ? settings.tolerance : default_static_tolerance;
    const SolveTolerance tolerance{std::max(share * scale, rounding), 0};

    const std::vector<Vec3> before = x;
    SolveReport total = newton(alone, x, tolerance, NewtonSteps::full, most_full);
    if (!total.converged && settings.tangent == Tangent::exact) {
        x = before;
        total.add(newton(alone, x, tolerance, NewtonSteps::guarded, most_guarded));
    }
    if (!total.converged) x = before;
    return total;
}

}  // namespace

SolveReport find_equilibrium(DynamicBody& b, const Surroundings& around, double start, double end,
                             const Threads& threads) {
    SolveReport report;
    if (!is_held(b)) {
        report.trouble =
            "its fixes leave it free to move or to turn as a whole, so that it has no equilibrium of its own: hold "
            "more of it, or use \"implicit-euler\" with damping";
        return report;
    }
    set_contact_stiffness(b, std::numeric_limits<double>::infinity());
    WarpedPreconditioner& preconditioner = b.prepare_preconditioner(1, 0, threads);
    IncrementalPotential potential(b, around, SolverPrecision::full, threads);
    CoupledBodies alone({{&potential, &preconditioner}}, nullptr, threads);
    std::vector<Vec3> x = b.state.x;
    const double carried = b.carried_load;
    for (double done = 0, step = 1; done < 1;) {
        const double share = std::min(1.0, done + step);
        potential.time = start + share * (end - start);
        potential.load_time = end;
        potential.load_share = carried + share * (1 - carried);
        const SolveReport solved = solve(potential, alone, x);
        report.add(solved);
        if (solved.converged) {
            done = share;
            continue;
        }
        if (around.solver.tangent != Tangent::exact) {
            report.trouble =
                "with the tangent of Brunet et al. 2019, which leaves out the change of rotation: " + solved.trouble +
                "; the exact tangent finds it";
            return report;
        }
        step /= 2;
        if (step < shortest_load_step) {
            report.trouble = "no equilibrium was found beyond " + format_number(100 * done) +
                             " % of the load, even in steps of " + format_number(100 * step) + " %: " + solved.trouble;
            return report;
        }
    }

    const IncrementalPotential::Forces forces = potential.forces(x);
    const BodyEnergy before = body_energy(b, around, threads);
    const Constraints::GripWork grips = b.constraints.measure(start, end, x, forces.sum);
    const double work = threads.sum(x.size(), node_chunk, [&](std::size_t i) {
        return dot(forces.loads[i], x[i] - b.state.x[i]);
    }) + 0.5 * (grips.nodes + grips.patches);
    b.penalty_energy = b.constraints.penalty_energy(end, x);
    b.state.x = std::move(x);
    std::fill(b.state.v.begin(), b.state.v.end(), Vec3{});
    b.carried_load = 1;

    // Loads that come all at once give more than is stored; the rest is what motion would have carried off.
    b.exchanged.external += work;
    b.exchanged.numerical += work - (body_energy(b, around, threads).total() - before.total());
    return report;
}

}  // namespace phyxel
