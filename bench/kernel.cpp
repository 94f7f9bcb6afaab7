#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/float_peak.h"
#include "bench/beam.h"
#include "forces/cell_blocks.h"
#include "forces/internal_forces.h"

namespace phyxel::bench {
namespace {

struct KernelRow {
    std::size_t nodes = 0, points = 0, pairs = 0;
    double uniform_share = 0, similar_share = 0;  ///< of chunks
    double bytes = 0;                             ///< of gradients and indices
    double rest_action = 0, loose_rest_action = 0, forces = 0, energy = 0, double_forces = 0;  ///< [s]

    /// Gathering and scattering a pair are nine multiplications and additions each.
    double flops(double seconds) const { return 36 * static_cast<double>(pairs) / seconds; }
    double nanoseconds_a_point() const { return 1e9 * rest_action / static_cast<double>(points); }
};

KernelRow measure(double spacing, const Threads& threads) {
    const Model model = beam_model(spacing, threads);
    const CellBlocks blocks(model, threads);
    const CellBlocks loose(model, threads, {.tolerance = 1e-2});
    const std::vector<Vec3> x = bent(model, 1.5);
    std::vector<Vec3> f(x.size());
    std::vector<Vec3f> d, out(x.size());
    for (const Vec3& v : x) d.push_back(vector_cast<float>(v));

    KernelRow row;
    row.nodes = x.size();
    row.points = model.stencils.points();
    row.pairs = model.stencils.pairs();
    const auto chunks = static_cast<double>(blocks.counts().chunks);
    row.uniform_share = static_cast<double>(blocks.counts().uniform_chunks) / chunks;
    row.similar_share = static_cast<double>(blocks.counts().similar_chunks) / chunks;
    row.bytes = static_cast<double>(blocks.counts().bytes);
    row.rest_action = shortest_call([&] { blocks.rest_action(model, d, threads, out); });
    row.forces = shortest_call([&] { blocks.forces(model, x, threads, f); });
    row.energy = shortest_call([&] { f[0].x = blocks.energy(model, x, threads); });
    row.loose_rest_action = shortest_call([&] { loose.rest_action(model, d, threads, out); });
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

void print_json(const std::vector<KernelRow>& rows, double peak, int threads) {
    nlohmann::ordered_json json;
    json["kernel"] = {{"peak_flops_a_core", peak}, {"threads", threads}};
    for (const KernelRow& row : rows)
        json["kernel"]["rows"].push_back({{"nodes", row.nodes},
                                          {"points", row.points},
                                          {"pairs", row.pairs},
                                          {"uniform_share", row.uniform_share},
                                          {"similar_share", row.similar_share},
                                          {"bytes", row.bytes},
                                          {"rest_action_seconds", row.rest_action},
                                          {"rest_action_flops", row.flops(row.rest_action)},
                                          {"forces_seconds", row.forces},
                                          {"energy_seconds", row.energy},
                                          {"loose_rest_action_seconds", row.loose_rest_action},
                                          {"double_forces_seconds", row.double_forces}});
    fmt::print("{}\n", json.dump(2));
}

void print_table(const std::vector<KernelRow>& rows, double peak, int threads) {
    fmt::print(
        "Forces of the 0.1 x 0.1 x 1 m beam in single precision, corotated, {} thread{}; peak {:.1f} GFlop/s a "
        "core\n\n",
        threads, threads == 1 ? "" : "s", 1e-9 * peak);
    const auto share = [&](const KernelRow& row, double seconds) {
        return 100 * row.flops(seconds) / (peak * threads);
    };
    fmt::print(
        "                                  stiffness at rest                |    with 1e-2     | forces  energy | "
        "double\n");
    fmt::print(
        " nodes uniform similar     MB |      ms  ns/point GFlop/s   peak |      ms    peak |     ms      ms | "
        "    ms   ratio\n");
    for (const KernelRow& r : rows)
        fmt::print(
            "{:>6} {:>6.0f}% {:>6.0f}% {:>6.1f} | {:>7.3f} {:>9.1f} {:>7.1f} {:>5.0f}% | {:>7.3f} {:>6.0f}% | "
            "{:>6.3f} {:>7.3f} | {:>6.3f} {:>7.1f}\n",
            r.nodes, 100 * r.uniform_share, 100 * r.similar_share, 1e-6 * r.bytes, 1e3 * r.rest_action,
            r.nanoseconds_a_point(), 1e-9 * r.flops(r.rest_action), share(r, r.rest_action), 1e3 * r.loose_rest_action,
            share(r, r.loose_rest_action), 1e3 * r.forces, 1e3 * r.energy, 1e3 * r.double_forces,
            r.double_forces / r.forces);
}

}  // namespace

int run_kernel(const Options& options) {
    const Threads threads(options.threads > 0 ? options.threads : 1);
    const double peak = peak_flops();
    std::vector<KernelRow> rows;
    for (const double spacing : beam_spacings) rows.push_back(measure(spacing, threads));
    if (options.as_json) print_json(rows, peak, threads.count());
    else print_table(rows, peak, threads.count());
    return 0;
}

}  // namespace phyxel::bench
