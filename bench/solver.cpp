#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/beam.h"
#include "forces/internal_forces.h"
#include "forces/stiffness_diagonal.h"
#include "solver/nodal_rotations.h"
#include "solver/nodal_vectors.h"
#include "solver/warped_preconditioner.h"

/// The linear system of an implicit step of 1/60 s, A = K(x) + M/dt^2 with the exact tangent K of the beam bent by half
/// a radian and gravity as the right-hand side, solved by conjugate gradients with the warped multigrid and with block
/// Jacobi in the same frames.

namespace phyxel::bench {
namespace {

constexpr double inertia = 3600;  ///< 1/dt^2 [1/s^2]
constexpr double solver_bend = 0.5;
constexpr double tolerances[] = {1e-2, 1e-6};  ///< of the error in the preconditioner's norm
constexpr int most_iterations = 3000;

struct SolveTime {
    int iterations = 0;
    double seconds = 0;
};

struct SolverRow {
    std::size_t nodes = 0;
    double setup = 0, cycle = 0, action = 0;  ///< [s]
    SolveTime multigrid[2], jacobi[2];        ///< to each of the tolerances
};

/// Preconditioned conjugate gradients for A d = b; `precondition(r, z)` and `multiply(d, product)`.
template <class Multiply, class Precondition>
SolveTime conjugate_gradients(std::vector<Vec3> b, double tolerance, const Threads& threads, Multiply&& multiply,
                              Precondition&& precondition) {
    const Clock::time_point start = Clock::now();
    std::vector<Vec3> d(b.size()), z(b.size()), p(b.size()), product(b.size());
    precondition(b, z);
    p = z;
    double rz = inner(b, z, threads);
    const double enough = tolerance * tolerance * rz;
    int k = 0;
    for (; k < most_iterations && rz > enough; ++k) {
        multiply(p, product);
        const double alpha = rz / inner(p, product, threads);
        add_scaled(d, alpha, p, threads);
        add_scaled(b, -alpha, product, threads);
        precondition(b, z);
        const double next = inner(b, z, threads);
        for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + next / rz * p[i];
        rz = next;
    }
    return {k, seconds_since(start)};
}

/// Diagonal blocks of A, inverted, in frames turned with the nodes.
std::vector<Mat3> block_jacobi(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    std::vector<Mat3> blocks = stiffness_diagonal(m, threads), rotation(x.size());
    NodalRotations(m, threads)
        .find(
            x, threads, [](std::size_t) { return true; }, rotation);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        for (std::size_t d = 0; d < 3; ++d) blocks[i](d, d) += inertia * m.mass[i];
        blocks[i] = rotation[i] * inverse(blocks[i]) * transpose(rotation[i]);
    }
    return blocks;
}

SolverRow measure_solver(double spacing, const Threads& threads) {
    const Model m = beam_model(spacing, threads);
    const std::vector<Vec3> x = bent(m, solver_bend);
    const std::size_t n = x.size();
    SolverRow row;
    row.nodes = n;

    const Clock::time_point start = Clock::now();
    WarpedPreconditioner multigrid(m, Constraints(), threads);
    multigrid.set_weights(1, inertia, threads);
    multigrid.turn(x, threads);
    row.setup = seconds_since(start);
    const std::vector<Mat3> jacobi = block_jacobi(m, x, threads);

    std::vector<Vec3> b(n), z(n);
    for (std::size_t i = 0; i < n; ++i) b[i] = m.mass[i] * Vec3{0, -9.81, 0};
    ForceWorkspace work;
    const auto multiply = [&](const std::vector<Vec3>& d, std::vector<Vec3>& out) {
        stiffness_action(m, x, d, work, threads, out);
        for (std::size_t i = 0; i < n; ++i) out[i] += inertia * m.mass[i] * d[i];
    };
    const auto with_multigrid = [&](const std::vector<Vec3>& r, std::vector<Vec3>& to) {
        multigrid.apply(r, to, threads);
    };
    const auto with_jacobi = [&](const std::vector<Vec3>& r, std::vector<Vec3>& to) {
        for (std::size_t i = 0; i < n; ++i) to[i] = jacobi[i] * r[i];
    };
    row.cycle = shortest_call([&] { with_multigrid(b, z); });
    row.action = shortest_call([&] { multiply(b, z); });
    for (int t = 0; t < 2; ++t) {
        row.multigrid[t] = conjugate_gradients(b, tolerances[t], threads, multiply, with_multigrid);
        row.jacobi[t] = conjugate_gradients(b, tolerances[t], threads, multiply, with_jacobi);
    }
    return row;
}

/// Exponent p of time ~ nodes^p by least squares in logarithms.
template <class Time>
double growth(const std::vector<SolverRow>& rows, Time&& time) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const SolverRow& row : rows) {
        const double a = std::log(double(row.nodes)), t = std::log(time(row));
        n += 1, x += a, y += t, xx += a * a, xy += a * t;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

int run_solver(const Options& options) {
    const Threads threads(options.threads > 0 ? options.threads : 1);
    if (!options.as_json) {
        fmt::print("Linear system of an implicit step, exact tangent in double, to 1e-2 and 1e-6; {} thread{}\n\n",
                   threads.count(), threads.count() == 1 ? "" : "s");
        fmt::print("{:>6} {:>9} {:>9} {:>9} | {:>5} {:>9} {:>5} {:>9} | {:>5} {:>9} {:>5} {:>9} | {:>6}\n", "nodes",
                   "setup ms", "cycle ms", "action ms", "it.", "multigrid", "it.", "ms", "it.", "b. Jacobi", "it.",
                   "ms", "to 1e-6");
    }
    nlohmann::ordered_json json;
    std::vector<SolverRow> rows;
    for (const double spacing : beam_spacings) {
        const auto across = static_cast<std::size_t>(std::lround(0.1 / spacing));
        const std::size_t nodes = (across + 1) * (across + 1) * (10 * across + 1);
        if (options.nodes > 0 && nodes != options.nodes) continue;
        const SolverRow row = measure_solver(spacing, threads);
        rows.push_back(row);
        const SolveTime *mg = row.multigrid, *bj = row.jacobi;
        if (options.as_json) {
            const auto solve = [](const SolveTime* s) {
                return nlohmann::ordered_json{{"iterations_1e-2", s[0].iterations},
                                              {"seconds_1e-2", s[0].seconds},
                                              {"iterations_1e-6", s[1].iterations},
                                              {"seconds_1e-6", s[1].seconds}};
            };
            json["solver"].push_back({{"nodes", row.nodes},
                                      {"setup_seconds", row.setup},
                                      {"cycle_seconds", row.cycle},
                                      {"action_seconds", row.action},
                                      {"multigrid", solve(mg)},
                                      {"block_jacobi", solve(bj)}});
            continue;
        }
        fmt::print(
            "{:>6} {:>9.1f} {:>9.3f} {:>9.3f} | {:>5} {:>9.2f} {:>5} {:>9.2f} | {:>5} {:>9.2f} {:>5} {:>9.2f} | "
            "{:>6.1f}\n",
            row.nodes, 1e3 * row.setup, 1e3 * row.cycle, 1e3 * row.action, mg[0].iterations, 1e3 * mg[0].seconds,
            mg[1].iterations, 1e3 * mg[1].seconds, bj[0].iterations, 1e3 * bj[0].seconds, bj[1].iterations,
            1e3 * bj[1].seconds, bj[1].seconds / mg[1].seconds);
        std::fflush(stdout);
    }
    if (options.as_json) fmt::print("{}\n", json.dump(2));
    else if (rows.size() > 2)
        fmt::print("\ntime grows with nodes^{:.2f} a cycle, nodes^{:.2f} a solve to 1e-2\n",
                   growth(rows, [](const SolverRow& row) { return row.cycle; }),
                   growth(rows, [](const SolverRow& row) { return row.multigrid[0].seconds; }));
    return 0;
}

}  // namespace phyxel::bench
