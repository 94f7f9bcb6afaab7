#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/benches.h"
#include "bench/child.h"
#include "geometry/thickness.h"
#include "geometry/winding_number.h"
#include "phyxel/error.h"
#include "phyxel/phyxel.h"
#include "solver/integrators.h"
#include "solver/step.h"

namespace phyxel::bench {
namespace {

/// Stages in their order. Those that begin with a blank are parts of the one before.
constexpr std::array stages = {
    "read",     "check",       "spacing search", "sampling", " clipping",     " components",     "thickness",
    "stencils", " correction", "filter",         "surface",  "step estimate", "contact samples", "first step",
};
constexpr std::size_t stage_count = stages.size();

/// From the mesh file to the end of the first step. Plain bytes, sent from a process of its own, as those below.
struct Whole {
    std::size_t nodes = 0;
    double seconds = 0;
    double processor_seconds = 0;  ///< of all threads together: what other work on the machine changes least
    double peak_bytes = 0;         ///< resident, above what the process held at its start
};

struct Stages {
    std::size_t pairs = 0;
    double seconds[stage_count] = {};
};

struct SetupRow {
    Whole explicit_step, implicit_step;
    Stages stages;
};

BodySettings settings_for(std::size_t nodes) {
    BodySettings settings;
    settings.count = nodes;
    settings.material = neo_hookean({.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.45});
    return settings;
}

/// The same surface of four times as many triangles.
TriangleMesh quartered(const TriangleMesh& mesh) {
    TriangleMesh fine;
    fine.vertices = mesh.vertices;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [at, is_new] =
            middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
        if (is_new) fine.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
        return at->second;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
            fine.triangles.push_back(t);
    }
    return fine;
}

/// A mesh file, or without one the bunny, quartered to some 15 thousand triangles.
TriangleMesh read(const std::string& file) {
    if (!file.empty()) return read_mesh(file);
    const std::string bunny = "scenes/meshes/bunny.obj";
    return quartered(access(bunny.c_str(), R_OK) == 0 ? read_mesh(bunny) : make_sphere(1));
}

/// As a user does it: mesh, world, body, one step.
template <class Read>
void measure_whole(Read&& read_surface, std::size_t nodes, Integrator integrator, int threads, Whole& m) {
    const double before = peak_bytes(), busy_before = processor_seconds();
    const Clock::time_point start = Clock::now();
    const TriangleMesh mesh = read_surface();
    World world({.time_step = 1e-9, .gravity = {0, -9.81, 0}, .integrator = integrator, .threads = threads});
    const BodyId body = world.add_body(mesh, settings_for(nodes));
    world.add_collider(Plane{.point = {0, -1e3, 0}});
    world.step();
    m.seconds = seconds_since(start);
    m.processor_seconds = processor_seconds() - busy_before;
    m.peak_bytes = peak_bytes() - before;
    m.nodes = world.rest_positions(body).size();
}

/// Stage by stage, by hand: what `World::add_body` calls.
void measure_stages(const std::string& file, std::size_t nodes, int thread_count, Stages& m) {
    std::size_t stage = 0;
    const auto timed = [&](auto&& work) {
        const Clock::time_point start = Clock::now();
        auto result = work();
        m.seconds[stage++] = seconds_since(start);
        return result;
    };
    const Threads threads(thread_count);
    const Surroundings around{{0, -9.81, 0}, 0, 0, {}};
    const BodySettings settings = settings_for(nodes);
    const TriangleMesh mesh = timed([&] { return read(file); });
    const CheckedMesh checked = timed([&] { return check_and_repair(mesh); });
    const double spacing = timed([&] { return spacing_for_count(checked, settings, threads); });
    Sampling sampling = timed([&] { return sample(checked, settings, spacing, threads); });

    // Parts of the sampling, once more.
    const TriangleMesh moved = to_lattice(checked.mesh, sampling.frame);
    const ClippedVolume clipped = timed([&] {
        if (checked.closed_and_simple) return clip_closed(moved, spacing / 2, threads);
        return clip_by_winding_number(moved, WindingNumber(moved), spacing / 2, threads);
    });
    timed([&] { return find_components(moved, clipped, threads).cells.size(); });
    timed([&] { return local_thickness(checked.mesh).thinnest; });

    // The model, without its filter, and without and with the correction.
    BodySettings bare = settings;
    bare.stabilization = 0;
    bare.consistency_correction = false;
    StencilReport report;
    const double plain = shortest(1, [&] { build_model(sampling, bare, threads, report); });
    bare.consistency_correction = true;
    DynamicBody body;
    body.model = timed([&] { return build_model(std::move(sampling), bare, threads, report); });
    m.seconds[stage] = m.seconds[stage - 1] - plain, ++stage;
    m.pairs = body.model.stencils.pairs();
    body.model.filter = timed([&] { return build_filter(body.model.sampling, body.model.approximation, threads); });
    const double a = body.model.node_length;
    for (double mass : body.model.mass)
        body.model.filter_stiffness.push_back(0.2 * settings.material.youngs_modulus * mass /
                                              (settings.material.density * a * a));
    body.state.x = body.model.rest;
    body.state.v.assign(body.model.rest.size(), Vec3{});
    body.surface.emplace(
        timed([&] { return EmbeddedSurface(body.model, checked.mesh, vertex_normals(checked.mesh), threads); }));
    timed([&] { return estimate_rest_step(body, around, threads), 0; });
    body.contact.emplace(timed([&] {
        return ContactSamples(body.model, contact_surface(body.model, checked.mesh, threads), body.rest_step, threads);
    }));
    timed([&] { return leap_frog(body, around, 0, body.rest_step, 1, threads), 0; });
}

double bytes_a_node(const Whole& m, double fixed) { return (m.peak_bytes - fixed) / static_cast<double>(m.nodes); }

void print_json(const std::string& mesh, std::size_t triangles, double fixed, const std::vector<SetupRow>& rows) {
    nlohmann::ordered_json json;
    json["setup"] = {{"mesh", mesh}, {"triangles", triangles}, {"fixed_bytes", fixed}};
    for (const SetupRow& row : rows) {
        nlohmann::ordered_json entry = {{"nodes", row.explicit_step.nodes}};
        for (const auto& [name, whole] :
             {std::pair("leap-frog", &row.explicit_step), {"implicit-euler", &row.implicit_step}})
            entry[name] = {{"seconds", whole->seconds},
                           {"processor_seconds", whole->processor_seconds},
                           {"peak_bytes", whole->peak_bytes},
                           {"peak_bytes_per_node", bytes_a_node(*whole, fixed)}};
        for (std::size_t s = 0; s < stage_count; ++s)
            entry["stages"][stages[s] + (stages[s][0] == ' ')] = row.stages.seconds[s];
        json["setup"]["rows"].push_back(entry);
    }
    fmt::print("{}\n", json.dump(2));
}

void print_table(const std::string& mesh, std::size_t triangles, double fixed, const std::vector<SetupRow>& rows) {
    fmt::print("From {} ({} triangles) to the first step; {:.1f} MB of the memory are those of any body\n\n", mesh,
               triangles, fixed / 1e6);
    const auto line = [&](const std::string& title, auto&& value) {
        fmt::print("{:<22}", title);
        for (const SetupRow& row : rows) fmt::print(" {:>12}", value(row));
        fmt::print("\n");
    };
    line("nodes", [](const SetupRow& row) { return fmt::format("{}", row.explicit_step.nodes); });
    line("pairs a node", [](const SetupRow& row) {
        return fmt::format("{:.0f}",
                           static_cast<double>(row.stages.pairs) / static_cast<double>(row.explicit_step.nodes));
    });
    for (const auto& [name, member] :
         {std::pair("leap-frog", &SetupRow::explicit_step), {"implicit Euler", &SetupRow::implicit_step}}) {
        const auto whole = [&](const char* title, const char* format, auto&& value) {
            line(title, [&](const SetupRow& row) { return fmt::format(fmt::runtime(format), value(row.*member)); });
        };
        fmt::print("{}\n", name);
        whole("  all [s]", "{:.3f}", [](const Whole& m) { return m.seconds; });
        whole("  all processors [s]", "{:.3f}", [](const Whole& m) { return m.processor_seconds; });
        whole("  a node [us]", "{:.1f}", [](const Whole& m) { return 1e6 * m.seconds / static_cast<double>(m.nodes); });
        whole("  peak memory [MB]", "{:.1f}", [](const Whole& m) { return m.peak_bytes / 1e6; });
        whole("  a node [kB]", "{:.1f}", [&](const Whole& m) { return bytes_a_node(m, fixed) / 1e3; });
    }
    fmt::print("\nstages of leap-frog [s], measured one by one\n");
    for (std::size_t s = 0; s < stage_count; ++s)
        line(fmt::format("  {}", stages[s]),
             [&](const SetupRow& row) { return fmt::format("{:.3f}", row.stages.seconds[s]); });
}

}  // namespace

int run_setup(const Options& options) {
    const std::string& file = options.mesh;
    std::vector<std::size_t> sizes = {2000, 20000};
    if (options.large) sizes.push_back(200000);
    if (options.nodes > 0) sizes = {options.nodes};
    const auto whole = [&](auto&& read_surface, std::size_t nodes, Integrator integrator) {
        return in_child<Whole>(
            [&](Whole& out) { measure_whole(read_surface, nodes, integrator, options.threads, out); });
    };
    // What a body of a few nodes takes: code and tables of the libraries, the pool of threads.
    const double fixed = whole([] { return make_box({1, 1, 1}); }, 27, Integrator::leap_frog).peak_bytes;
    const auto read_file = [&] { return read(file); };
    std::vector<SetupRow> rows;
    for (const std::size_t nodes : sizes)
        rows.push_back({whole(read_file, nodes, Integrator::leap_frog),
                        whole(read_file, nodes, Integrator::implicit_euler),
                        in_child<Stages>([&](Stages& out) { measure_stages(file, nodes, options.threads, out); })});
    const std::size_t triangles = read(file).triangles.size();
    const std::string name = file.empty() ? "the bunny, quartered" : file;
    if (options.as_json) print_json(name, triangles, fixed, rows);
    else print_table(name, triangles, fixed, rows);
    return 0;
}

}  // namespace phyxel::bench
