#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/benches.h"
#include "bench/child.h"
#include "phyxel/phyxel.h"
#include "reference/fem/solve.h"

/// A beam of 0.1 x 0.1 x 1 m along z, held at z = 0, falls from straight under its weight and comes to rest: E = 1e6 Pa
/// (a heavy beam that hangs down and whips on its way) and 1e9 Pa (a stiff one), nu = 0.3, 1000 kg/m^3, 9.81 m/s^2,
/// 300 implicit Euler steps of 1/60 s, mass damping 4/s. What is read is the mean displacement of the end face.

namespace phyxel::bench {
namespace {

constexpr Vec3 beam = {0.1, 0.1, 1};
constexpr double dt = 1.0 / 60, damping = 4;
constexpr std::size_t steps = 300, batch = 30, batches = steps / batch;
constexpr std::size_t sizes[] = {2, 3, 4, 5, 7, 9, 14};  ///< cells across: 189 nodes, 496, ... 9100, 31725
constexpr int runs = 2;  ///< of which the shorter time of each batch counts; above 2000 nodes there is one

struct Case {
    const char* name;
    double youngs_modulus;
    double rest_y,
        rest_z;  ///< [m] mean displacement of the end face at rest: two finite elements of high order, to 1e-4
};
constexpr Case cases[] = {{"heavy, 1e6 Pa", 1e6, -0.7468, -0.3968}, {"stiff, 1e9 Pa", 1e9, -1.469e-3, 0}};

Material material_of(const Case& c) {
    return corotated({.density = 1000, .youngs_modulus = c.youngs_modulus, .poissons_ratio = 0.3});
}

/// Height of the end face over the steps: where it swings to first, and where it ends.
struct Swing {
    std::size_t peak_step = 0;  ///< first step that is lower than the next
    double peak = 0;            ///< [m]
    Vec3 end;                   ///< [m]

    void add(std::size_t step, const Vec3& tip) {
        if (!turned_ && step > 1 && tip.y > end.y) peak = end.y, peak_step = step - 1, turned_ = true;
        end = tip;
    }

private:
    bool turned_ = false;
};

/// Plain bytes, sent from a process of its own.
struct Run {
    std::size_t nodes = 0, retries = 0;
    Swing swing;
    double processor[batches] = {}, wall[batches] = {};  ///< [s] without the first step, which makes the solver
    double first_step = 0;                               ///< [s]
    double iterations = 0;                               ///< a step, mean
    std::size_t most_iterations = 0;
    double setup_seconds = 0, peak_bytes = 0;  ///< [s], [B] above what the process held at its start
    bool completed = true;
};

void run_meshless(const Case& c, std::size_t cells, int threads, Run& run) {
    const double held = peak_bytes(), start = processor_seconds();
    World world(
        {.time_step = dt, .integrator = Integrator::implicit_euler, .mass_damping = damping, .threads = threads});
    BodySettings settings;
    settings.spacing = beam.x / double(cells);
    settings.translation = 0.5 * beam;
    settings.material = material_of(c);
    const BodyId body = world.add_body(make_box(beam), settings);
    world.add_fix(body, {.box = {{-1, -1, -1e-9}, {1, 1, 1e-9}}});
    // The mean over the face by Gauss' rule of 3 x 3 points.
    const double offset[] = {0.5 - 0.5 * std::sqrt(0.6), 0.5, 0.5 + 0.5 * std::sqrt(0.6)};
    const double weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    std::size_t probes[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            probes[i][j] = world.add_probe(body, {beam.x * offset[i], beam.y * offset[j], beam.z});
    run.nodes = world.positions(body).size();
    run.setup_seconds = processor_seconds() - start;

    for (std::size_t b = 0; b < batches; ++b) {
        double before = processor_seconds();
        Clock::time_point clock = Clock::now();
        for (std::size_t step = b * batch + 1; step <= (b + 1) * batch; ++step) {
            const StepReport report = world.step();
            run.completed = run.completed && report.status == StepStatus::ok;
            run.retries += report.retries;
            run.iterations += double(report.newton_iterations) / double(steps);
            run.most_iterations = std::max(run.most_iterations, report.newton_worst);
            Vec3 tip;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    const ProbeReading now = world.probe(probes[i][j]);
                    tip += weight[i] * weight[j] * (now.position - now.rest);
                }
            run.swing.add(step, tip);
            if (step > 1) continue;
            run.first_step = processor_seconds() - before;
            before = processor_seconds();
            clock = Clock::now();
        }
        run.processor[b] = processor_seconds() - before;
        run.wall[b] = seconds_since(clock);
    }
    run.peak_bytes = peak_bytes() - held;
}

/// The same by triquadratic hexahedra of n x n x 10 n boxes, exact steps: what both swings should come to.
Swing run_elements(const Case& c, std::size_t n) {
    using namespace fem;
    const Solid solid(box_mesh(ElementType::hexahedra_27, {n, n, 10 * n}, beam), material_of(c));
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    add_gravity(conditions, solid, {0, -9.81, 0});
    System system(solid, conditions);
    fem::State state = at_rest(solid);
    Swing swing;
    for (std::size_t step = 1; step <= 70; ++step) {
        step_implicit_euler(system, state, dt, damping, {.tolerance = 1e-7});
        std::vector<Vec3> u = state.x;
        for (std::size_t i = 0; i < u.size(); ++i) u[i] -= solid.mesh.X[i];
        swing.add(step, face_mean(solid.mesh, u, Face::z_max));
    }
    return swing;
}

/// One line of the table: a size with the threads it ran on.
struct Row {
    int threads;
    Run run;
    double processor_ms, wall_ms,
        slowest_ms;  ///< a step: mean over the batches, each the shorter of its runs; slowest batch
};

Row measure(const Case& c, std::size_t cells, int threads) {
    Row row{threads, {}, 0, 0, 0};
    double processor[batches] = {}, wall[batches] = {};
    for (int r = 0; r < (cells < 6 ? runs : 1); ++r) {
        row.run = in_child<Run>([&](Run& out) { run_meshless(c, cells, threads, out); });
        for (std::size_t b = 0; b < batches; ++b) {
            processor[b] = r == 0 ? row.run.processor[b] : std::min(processor[b], row.run.processor[b]);
            wall[b] = r == 0 ? row.run.wall[b] : std::min(wall[b], row.run.wall[b]);
        }
    }
    for (std::size_t b = 0; b < batches; ++b) {
        row.processor_ms += 1e3 * processor[b] / double(steps - 1);
        row.wall_ms += 1e3 * wall[b] / double(steps - 1);
        row.slowest_ms = std::max(row.slowest_ms, 1e3 * processor[b] / double(batch));
    }
    return row;
}

/// Difference of the end from the reference, relative to the reference's length [%].
double tip_error(const Case& c, const Run& run) {
    const double y = run.swing.end.y - c.rest_y, z = c.rest_z != 0 ? run.swing.end.z - c.rest_z : 0;
    return 100 * std::hypot(y, z) / std::hypot(c.rest_y, c.rest_z);
}

/// Power of the nodes that the time of a step grows with between two sizes.
double growth(const Row& small, const Row& large) {
    return std::log(large.processor_ms / small.processor_ms) /
           std::log(double(large.run.nodes) / double(small.run.nodes));
}

void print_row(const Case& c, const Row& row) {
    const Run& run = row.run;
    fmt::print(
        "{:>6} {:>7} {:>8.2f} {:>11.5g} {:>11.5g} {:>11.5g} {:>5} {:>9.3f} {:>9.3f} {:>9.3f} {:>7.2f} {:>5} "
        "{:>8.1f} {:>8.1f}{}\n",
        run.nodes, row.threads, tip_error(c, run), run.swing.end.y, run.swing.end.z, run.swing.peak,
        run.swing.peak_step, row.processor_ms, row.slowest_ms, row.wall_ms, run.iterations, run.most_iterations,
        run.peak_bytes / 1e6, 1e3 * run.first_step, run.completed ? "" : "  FAILED");
    std::fflush(stdout);
}

nlohmann::ordered_json row_json(const Case& c, const Row& row) {
    const Run& run = row.run;
    return {{"nodes", run.nodes},
            {"threads", row.threads},
            {"completed", run.completed},
            {"tip_error_percent", tip_error(c, run)},
            {"tip", {run.swing.end.x, run.swing.end.y, run.swing.end.z}},
            {"first_peak", run.swing.peak},
            {"first_peak_step", run.swing.peak_step},
            {"processor_ms_per_step", row.processor_ms},
            {"slowest_batch_ms_per_step", row.slowest_ms},
            {"wall_ms_per_step", row.wall_ms},
            {"iterations_per_step", run.iterations},
            {"most_iterations", run.most_iterations},
            {"retries", run.retries},
            {"setup_seconds", run.setup_seconds},
            {"first_step_seconds", run.first_step},
            {"peak_bytes", run.peak_bytes}};
}

}  // namespace

int run_cantilever(const Options& options) {
    nlohmann::ordered_json json;
    bool completed = true;
    for (const Case& c : cases) {
        if (!options.as_json) {
            fmt::print("{}: at rest y = {:g} m{}\n\n", c.name, c.rest_y,
                       c.rest_z != 0 ? fmt::format(", z = {:g} m", c.rest_z) : "");
            fmt::print("{:>6} {:>7} {:>8} {:>11} {:>11} {:>11} {:>5} {:>9} {:>9} {:>9} {:>7} {:>5} {:>8} {:>8}\n",
                       "nodes", "threads", "error %", "tip y [m]", "tip z [m]", "1st peak", "step", "cpu ms", "slowest",
                       "wall ms", "iter.", "most", "MB", "1st ms");
        }
        std::vector<Row> alone;  // rows of one thread
        for (const std::size_t cells : sizes) {
            const std::size_t nodes = (cells + 1) * (cells + 1) * (10 * cells + 1);
            if (options.nodes > 0 && nodes != options.nodes) continue;
            for (const int threads : {1, 2}) {
                if (options.threads > 0 && threads != options.threads) continue;
                const Row row = measure(c, cells, threads);
                completed = completed && row.run.completed;
                if (threads == 1) alone.push_back(row);
                if (options.as_json) json[c.name].push_back(row_json(c, row));
                else print_row(c, row);
            }
        }
        if (!options.as_json && alone.size() > 2)
            fmt::print("one thread: time a step grows with nodes^{:.2f} from {} to {} nodes\n",
                       growth(alone[1], alone.back()), alone[1].run.nodes, alone.back().run.nodes);
        if (options.reference) {
            const Swing swing = run_elements(c, 2);
            if (options.as_json)
                json[c.name + std::string(", 27-node hexahedra")] = {{"first_peak", swing.peak},
                                                                     {"first_peak_step", swing.peak_step}};
            else
                fmt::print("1025 nodes of 27-node hexahedra: first peak {:.5g} m at step {}\n", swing.peak,
                           swing.peak_step);
        }
        if (!options.as_json) fmt::print("\n");
    }
    if (options.as_json) fmt::print("{}\n", json.dump(2));
    return completed ? 0 : 1;
}

}  // namespace phyxel::bench
