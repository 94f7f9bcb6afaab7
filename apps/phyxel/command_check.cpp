#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "phyxel/mesh.h"
#include "sampling/memory_guard.h"

namespace phyxel::cli {
namespace {

constexpr double node_counts[] = {500, 2000, 20000, 200000};

using Json = nlohmann::ordered_json;

/// The spacing at which a cubic lattice has `count` nodes in the mesh; the estimate falls as the spacing rises.
double spacing_for(const MeshReport& mesh, double count) {
    double fine = 1e-6 * norm(mesh.upper - mesh.lower), coarse = norm(mesh.upper - mesh.lower);
    for (int i = 0; i < 100; ++i) {
        const double middle = std::sqrt(fine * coarse);
        (estimate_nodes(mesh, middle, 1) > count ? fine : coarse) = middle;
    }
    return coarse;
}

Json json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json json(const std::vector<Vec3>& places) {
    Json all = Json::array();
    for (const Vec3& place : places) all.push_back(json(place));
    return all;
}

Json report_json(const std::string& file, const MeshReport& mesh) {
    Json spacings = Json::array();
    if (mesh.can_be_simulated)
        for (const double count : node_counts)
            spacings.push_back({{"nodes", count}, {"spacing", spacing_for(mesh, count)}});
    return {{"mesh", file},
            {"can_be_simulated", mesh.can_be_simulated},
            {"refusal", mesh.refusal},
            {"repairs", mesh.repairs},
            {"vertices", mesh.vertices},
            {"triangles", mesh.triangles},
            {"closed", mesh.closed()},
            {"manifold", mesh.manifold()},
            {"oriented", mesh.oriented()},
            {"inside_out", mesh.inside_out},
            {"duplicate_vertices", mesh.duplicate_vertices},
            {"unused_vertices", mesh.unused_vertices},
            {"degenerate_triangles", mesh.degenerate_triangles},
            {"duplicate_triangles", mesh.duplicate_triangles},
            {"flipped_triangles", mesh.flipped_triangles},
            {"boundary_edges", mesh.boundary_edges},
            {"holes", mesh.holes},
            {"hole_places", json(mesh.hole_places)},
            {"nonmanifold_edges", mesh.nonmanifold_edges},
            {"nonmanifold_vertices", mesh.nonmanifold_vertices},
            {"inconsistent_edges", mesh.inconsistent_edges},
            {"self_intersections", mesh.self_intersections},
            {"intersection_places", json(mesh.intersection_places)},
            {"components", mesh.components},
            {"genus", mesh.genus},
            {"area", mesh.area},
            {"signed_volume", mesh.signed_volume},
            {"volume", mesh.volume},
            {"lower", json(mesh.lower)},
            {"upper", json(mesh.upper)},
            {"spacings", spacings}};
}

void print_places(const char* what, const std::vector<Vec3>& places) {
    for (const Vec3& place : places)
        fmt::print("    {} at ({:.6g}, {:.6g}, {:.6g})\n", what, place.x, place.y, place.z);
}

void print_report(const std::string& file, const MeshReport& mesh) {
    fmt::print("{}\n", file);
    fmt::print("  size               {} vertices, {} triangles, {} component{}\n", mesh.vertices, mesh.triangles,
               mesh.components, mesh.components == 1 ? "" : "s");
    fmt::print("  bounding box       ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", mesh.lower.x,
               mesh.lower.y, mesh.lower.z, mesh.upper.x, mesh.upper.y, mesh.upper.z);
    fmt::print(
        "  closed             {}\n",
        mesh.closed() ? "yes" : fmt::format("no, {} boundary edges in {} holes", mesh.boundary_edges, mesh.holes));
    print_places("hole", mesh.hole_places);
    fmt::print("  manifold           {}\n", mesh.manifold()
                                                ? "yes"
                                                : fmt::format("no, {} edges and {} vertices are not",
                                                              mesh.nonmanifold_edges, mesh.nonmanifold_vertices));
    fmt::print("  oriented           {}\n",
               mesh.oriented() ? "yes" : fmt::format("no, {} edges disagree", mesh.inconsistent_edges));
    fmt::print("  self-intersections {}\n", mesh.self_intersections);
    print_places("crossing", mesh.intersection_places);
    if (mesh.closed() && mesh.manifold()) fmt::print("  genus              {}\n", mesh.genus);
    fmt::print("  area               {:.6g}\n", mesh.area);
    fmt::print("  volume             {:.6g} inside by winding number, {:.6g} signed\n", mesh.volume,
               mesh.signed_volume);
    for (const std::string& repair : mesh.repairs) fmt::print("  repair             {}\n", repair);
    if (!mesh.can_be_simulated) {
        fmt::print("  can be simulated   no: {}\n", mesh.refusal);
        return;
    }
    fmt::print("  can be simulated   yes\n\n  nodes     spacing, in the mesh's unit\n");
    for (const double count : node_counts) fmt::print("  {:<9} {:.4g}\n", count, spacing_for(mesh, count));
}

}  // namespace

int check(const CheckArguments& arguments) {
    const MeshReport report = check_mesh(read_mesh(arguments.mesh, arguments.part));
    if (arguments.as_json)
        fmt::print("{}\n", report_json(arguments.mesh, report).dump(2, ' ', false, Json::error_handler_t::replace));
    else print_report(arguments.mesh, report);
    return success;
}

}  // namespace phyxel::cli
