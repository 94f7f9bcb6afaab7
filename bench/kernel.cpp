#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/float_peak.h"
#include "bench/benches.h"
#include "forces/cell_blocks.h"
#include "forces/filter_action.h"
#include "forces/internal_forces.h"
#include "geometry/mesh_check.h"
#include "phyxel/mesh.h"

namespace phyxel::bench {
namespace {

/// Spacings [m] of the beam of 0.1 x 0.1 x 1 m: 496, 1,025, 1,836, 4,544, 9,100 and 31,725 nodes.
constexpr double spacings[] = {0.1 / 3, 0.1 / 4, 0.1 / 5, 0.1 / 7, 0.1 / 9, 0.1 / 14};
constexpr double seconds_a_measurement = 0.3;

struct Row {
    std::size_t nodes = 0, points = 0, pairs = 0;
    double uniform_share = 0;                                                       ///< of chunks
    double bytes = 0;                                                               ///< of gradients and indices
    double rest_action = 0, forces = 0, energy = 0, filter = 0, double_forces = 0;  ///< [s]

    /// Gathering and scattering a pair are nine multiplications and additions each.
    double rest_flops() const { return 36 * static_cast<double>(pairs) / rest_action; }
    double nanoseconds_a_point() const { return 1e9 * rest_action / static_cast<double>(points); }
};

Model beam_model(double spacing, const Threads& threads) {
    BodySettings settings;
    settings.spacing = spacing;
    settings.material = corotated({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3});
    StencilReport report;
    return build_model(sample(check_and_repair(make_box({0.1, 0.1, 1})), settings, spacing, threads), settings, threads,
                       report);
}

/// The beam bent by 1.5 radians and twisted a little.
std::vector<Vec3> bent(const Model& model) {
    std::vector<Vec3> x;
    for (const Vec3& X : model.rest) {
        const double angle = 1.5 * X.z, radius = 1 / 1.5 + X.x;
        x.push_back({radius * std::cos(angle), X.y + 0.1 * X.x * X.z, radius * std::sin(angle)});
    }
    return x;
}

/// Shortest time of a call, of as many as fit the time of a measurement.
template <class Work>
double shortest_call(Work&& work) {
    const double once = std::max(1e-6, shortest(3, work));
    return shortest(std::max(5, static_cast<int>(seconds_a_measurement / once)), work);
}

Row measure(double spacing, const Threads& threads) {
    const Model model = beam_model(spacing, threads);
    const CellBlocks blocks(model, threads);
    const FilterAction filter(model);
    const std::vector<Vec3> x = bent(model);
    std::vector<Vec3> f(x.size());
    std::vector<Vec3f> d, out(x.size());
    for (const Vec3& v : x) d.push_back(vector_cast<float>(v));

    Row row;
    row.nodes = x.size();
    row.points = model.stencils.points();
    row.pairs = model.stencils.pairs();
    row.uniform_share =
        static_cast<double>(blocks.counts().uniform_chunks) / static_cast<double>(blocks.counts().chunks);
    row.bytes = static_cast<double>(blocks.counts().bytes);
    row.rest_action = shortest_call([&] { blocks.rest_action(model, d, threads, out); });
    row.forces = shortest_call([&] { blocks.forces(model, x, threads, f); });
    row.energy = shortest_call([&] { f[0].x = blocks.energy(model, x, threads); });
    row.filter = shortest_call([&] { filter.add(d, threads, out); });
    ForceWorkspace work;
    Model elastic = model;
    elastic.filter = {};  // what the blocks leave out
    row.double_forces = shortest_call([&] { internal_forces(elastic, x, {}, 0, work, threads, f); });
    return row;
}

/// Floating point operations a second of one core.
double peak_flops() {
    constexpr std::size_t rounds = 2000;
    const double flops = run_float_peak(best_instructions(), rounds);
    return flops / shortest(2000, [&] { run_float_peak(best_instructions(), rounds); });
}

void print_json(const std::vector<Row>& rows, double peak, int threads) {
    nlohmann::ordered_json json;
    json["kernel"] = {{"peak_flops_a_core", peak}, {"threads", threads}};
    for (const Row& row : rows)
        json["kernel"]["rows"].push_back({{"nodes", row.nodes},
                                          {"points", row.points},
                                          {"pairs", row.pairs},
                                          {"uniform_share", row.uniform_share},
                                          {"bytes", row.bytes},
                                          {"rest_action_seconds", row.rest_action},
                                          {"rest_action_flops", row.rest_flops()},
                                          {"forces_seconds", row.forces},
                                          {"energy_seconds", row.energy},
                                          {"filter_seconds", row.filter},
                                          {"double_forces_seconds", row.double_forces}});
    fmt::print("{}\n", json.dump(2));
}

void print_table(const std::vector<Row>& rows, double peak, int threads) {
    fmt::print(
        "Forces of the 0.1 x 0.1 x 1 m beam in single precision, corotated, {} thread{}; peak {:.1f} GFlop/s a "
        "core\n\n",
        threads, threads == 1 ? "" : "s", 1e-9 * peak);
    fmt::print("{:>6} {:>8} {:>6} | {:>9} {:>9} {:>8} {:>6} | {:>9} {:>9} {:>9} | {:>9} {:>6}\n", "nodes", "uniform",
               "MB", "rest [ms]", "ns/point", "GFlop/s", "peak", "force", "energy", "filter", "double", "ratio");
    for (const Row& r : rows)
        fmt::print(
            "{:>6} {:>7.0f}% {:>6.1f} | {:>9.3f} {:>9.1f} {:>8.1f} {:>5.0f}% | {:>9.3f} {:>9.3f} {:>9.3f} | {:>9.3f} "
            "{:>6.1f}\n",
            r.nodes, 100 * r.uniform_share, 1e-6 * r.bytes, 1e3 * r.rest_action, r.nanoseconds_a_point(),
            1e-9 * r.rest_flops(), 100 * r.rest_flops() / (peak * threads), 1e3 * r.forces, 1e3 * r.energy,
            1e3 * r.filter, 1e3 * r.double_forces, r.double_forces / r.forces);
}

}  // namespace

int run_kernel(const Options& options) {
    const Threads threads(options.threads > 0 ? options.threads : 1);
    const double peak = peak_flops();
    std::vector<Row> rows;
    for (const double spacing : spacings) rows.push_back(measure(spacing, threads));
    if (options.as_json) print_json(rows, peak, threads.count());
    else print_table(rows, peak, threads.count());
    return 0;
}

}  // namespace phyxel::bench
