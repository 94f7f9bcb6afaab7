#include "bench/table_5_1.h"

#include <fmt/format.h>
#include <time.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/benches.h"
#include "reference/thesis_2008.h"
#include "solver/integrators.h"
#include "solver/step.h"

namespace phyxel::bench {
namespace {

constexpr double spacing = 0.1;  // [m]
// The rows take turns, so that whatever else the machine does comes upon all of them; the shortest of each row counts.
constexpr int rounds = 200;
// As many as the solver takes between two looks at the stable step. A run evaluates the forces once more than it steps.
constexpr std::size_t steps_a_run = 32;
constexpr Vec3 gravity = {0, -9.81, 0};

Material rubber() { return saint_venant_kirchhoff({.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3}); }

struct TableRow {
    std::size_t nodes = 0, pairs = 0;
    double mean_neighbors = 0;
    double thesis_per_second = 0, ours_per_second = 0;
    double reference_per_second = 0;  ///< of the literal code; 0: not asked for

    double ratio() const { return ours_per_second / thesis_per_second; }
    double step_seconds() const { return 1 / ours_per_second; }
};

/// The thesis' method on whole cells: nodal gradients, poly6, Saint Venant-Kirchhoff, nothing added.
DynamicBody make_body(const TableBody& row, const Surroundings& around, const Threads& threads) {
    BodySettings settings;
    settings.spacing = spacing;
    settings.quadrature = Quadrature::nodes;
    settings.kernel = {.shape = KernelShape::poly6, .support = support(row, spacing) / spacing};
    settings.material = rubber();
    settings.consistency_correction = false;
    settings.stabilization = 0;
    const std::array<int, 3> counts = {int(row.nodes[0]), int(row.nodes[1]), int(row.nodes[2])};
    DynamicBody body;
    StencilReport report;
    body.model = build_model(whole_cells(counts, spacing), settings, threads, report);
    body.state.x = body.model.rest;
    body.state.v.assign(body.model.rest.size(), Vec3{});
    estimate_rest_step(body, around, threads);
    return body;
}

/// Time [s] that this thread has been at work, without what others took of its processor.
double thread_seconds() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Leap-frog steps a second of each body, internal forces and gravity included; fills in the pairs too.
void measure_steps(std::vector<TableRow>& rows) {
    const Threads threads(1);
    const Surroundings around{gravity, 0, 0, {}};
    std::vector<DynamicBody> bodies;
    for (const TableBody& body : table_5_1) bodies.push_back(make_body(body, around, threads));
    std::vector<double> shortest_run(rows.size(), 1e300);
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const double start = thread_seconds();
            leap_frog(bodies[i], around, 0, bodies[i].rest_step, steps_a_run, threads);
            shortest_run[i] = std::min(shortest_run[i], thread_seconds() - start);
        }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].pairs = bodies[i].model.stencils.pairs();
        rows[i].ours_per_second = static_cast<double>(steps_a_run) / shortest_run[i];
    }
}

/// Steps a second of the listing, line by line.
double reference_per_second(const TableBody& row) {
    reference::Body body;
    body.X = positions(row, spacing);
    body.volume.assign(body.X.size(), spacing * spacing * spacing);
    body.mass.assign(body.X.size(), rubber().density * spacing * spacing * spacing);
    body.support = support(row, spacing);
    const Lame lame = material_point(rubber()).lame;
    body.lambda = lame.lambda;
    body.mu = lame.mu;
    body.gravity = gravity;
    const std::vector<Vec3> zero(body.X.size());
    reference::State state = reference::start(body, zero, zero, 1e-4);
    return 1 / shortest(2, [&] { reference::leap_frog_step(body, state, 1e-4); });
}

/// Least squares t = fixed + per_pair pairs.
struct LinearFit {
    double fixed = 0, per_pair = 0, r_squared = 0;
};

LinearFit fit_time_to_pairs(const std::vector<TableRow>& rows) {
    const auto mean = [&](auto&& value) {
        double sum = 0;
        for (const TableRow& row : rows) sum += value(row);
        return sum / static_cast<double>(rows.size());
    };
    const auto pairs = [](const TableRow& row) { return static_cast<double>(row.pairs); };
    const double x = mean(pairs), t = mean([](const TableRow&row) { return row.step_seconds(); });
    const double xx = mean([&](const TableRow& row) { return (pairs(row) - x) * (pairs(row) - x); });
    const double xt = mean([&](const TableRow& row) { return (pairs(row) - x) * (row.step_seconds() - t); });
    const double tt = mean([&](const TableRow& row) { return (row.step_seconds() - t) * (row.step_seconds() - t); });
    return {t - xt / xx * x, xt / xx, xt * xt / (xx * tt)};
}

void print_json(const std::vector<TableRow>& rows, const LinearFit& fit) {
    nlohmann::ordered_json json;
    for (const TableRow& row : rows) {
        nlohmann::ordered_json entry = {{"nodes", row.nodes},
                                        {"mean_neighbors", row.mean_neighbors},
                                        {"thesis_frames_per_second", row.thesis_per_second},
                                        {"steps_per_second", row.ours_per_second},
                                        {"ratio", row.ratio()}};
        if (row.reference_per_second > 0) entry["reference_steps_per_second"] = row.reference_per_second;
        json["table-5.1"]["rows"].push_back(entry);
    }
    json["table-5.1"]["seconds_per_step"] = {
        {"fixed", fit.fixed}, {"per_pair", fit.per_pair}, {"r_squared", fit.r_squared}};
    fmt::print("{}\n", json.dump(2));
}

void print_table(const std::vector<TableRow>& rows, const LinearFit& fit) {
    const bool reference = rows.front().reference_per_second > 0;
    fmt::print("Table 5.1 of the 2008 thesis: leap-frog steps a second, double precision, one thread\n\n");
    fmt::print("{:>6} {:>10} {:>9} {:>10} {:>10} {:>7}{}\n", "nodes", "neighbours", "pairs", "thesis/s", "phyxel/s",
               "ratio", reference ? "  listing/s" : "");
    for (const TableRow& row : rows) {
        fmt::print("{:>6} {:>10.1f} {:>9} {:>10.1f} {:>10.0f} {:>7.0f}", row.nodes, row.mean_neighbors, row.pairs,
                   row.thesis_per_second, row.ours_per_second, row.ratio());
        if (reference) fmt::print(" {:>10.2f}", row.reference_per_second);
        fmt::print("\n");
    }
    fmt::print("\ntime a step = {:.2f} us + {:.2f} ns a node pair, R^2 = {:.4f}\n", fit.fixed * 1e6, fit.per_pair * 1e9,
               fit.r_squared);
}

}  // namespace

int run_table_5_1(const Options& options) {
    std::vector<TableRow> rows(table_5_1.size());
    measure_steps(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const TableBody& body = table_5_1[i];
        rows[i].nodes = node_count(body);
        rows[i].thesis_per_second = body.thesis_frames_per_second;
        rows[i].mean_neighbors = static_cast<double>(rows[i].pairs) / static_cast<double>(rows[i].nodes);
        if (options.reference) rows[i].reference_per_second = reference_per_second(body);
    }
    const LinearFit fit = fit_time_to_pairs(rows);
    if (options.as_json) print_json(rows, fit);
    else print_table(rows, fit);
    return 0;
}

}  // namespace phyxel::bench
