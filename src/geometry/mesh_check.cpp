#include "geometry/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "geometry/mesh_measure.h"
#include "geometry/mesh_repair.h"
#include "geometry/mesh_topology.h"
#include "geometry/triangle_intersection.h"
#include "geometry/winding_volume.h"

namespace phyxel {

namespace {

constexpr double largest_coordinate = 1e20,
                 smallest_size = 1e-20;              // products of six lengths stay within double's range
constexpr double smallest_size_per_distance = 1e-9;  // of the mesh, to its distance from the origin
constexpr double flat_volume = 1e-12;                // per area and size: rounding of the volume's sum
constexpr double largest_doubtful_share = 0.5;

std::string text(double value) { return fmt::format("{:.6g}", value); }

std::string text(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x, x.y, x.z); }

std::string count(std::size_t n, const char* one, const char* many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// Why the numbers themselves cannot be worked with; empty when they can.
std::string unusable_numbers(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return "the mesh has no triangle: give a closed surface";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t v : mesh.triangles[t]) {
            const std::string place = "triangle " + std::to_string(t) + ", vertex " + std::to_string(v);
            if (v >= mesh.vertices.size())
                return place + ": the mesh has only " + std::to_string(mesh.vertices.size()) +
                       " vertices: mend the index";
            const Vec3& x = mesh.vertices[v];
            if (!is_finite(x)) return place + ": a coordinate is not a finite number: mend it";
            const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
            if (largest > largest_coordinate)
                return place + ": a coordinate at " + text(x) +
                       " is too large to work with: remove the vertex, or scale the mesh to metres";
        }
    const Bounds box = bounding_box(mesh);
    const Vec3 size = box.size();
    const double longest = std::max({size.x, size.y, size.z});
    double farthest = 0;
    for (const Vec3& corner : {box.lower, box.upper})
        farthest = std::max({farthest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
    if (longest < smallest_size)
        return "the whole mesh, near " + text(box.center()) + ", is only " + text(longest) +
               " long: scale it to metres";
    if (longest < smallest_size_per_distance * farthest)
        return "the mesh is " + text(longest) + " long but " + text(farthest) +
               " from the origin, too far to keep its digits: move it to the origin";
    return {};
}

void describe_repairs(MeshReport& r) {
    const auto say = [&](std::size_t n, const char* one, const char* many, const char* what) {
        if (n > 0) r.repairs.push_back(count(n, one, many) + " " + what);
    };
    say(r.duplicate_vertices, "vertex", "vertices", "at the place of another welded to it");
    say(r.unused_vertices, "vertex", "vertices", "that no triangle uses dropped");
    say(r.degenerate_triangles, "triangle", "triangles", "with a vertex twice dropped");
    say(r.duplicate_triangles, "triangle", "triangles", "given twice dropped");
    say(r.flipped_triangles, "triangle", "triangles", "turned to agree with their neighbours");
    if (r.inside_out) r.repairs.push_back("the surface was inside out and was turned");
}

void count_edges(const TriangleMesh& mesh, const EdgeTable& edges, MeshReport& r) {
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto sides = edges.sides(e);
        r.boundary_edges += sides.size() == 1;
        r.nonmanifold_edges += sides.size() > 2;
        r.inconsistent_edges += sides.size() == 2 && origin_of(mesh, sides[0]) == origin_of(mesh, sides[1]);
    }
}

void measure_topology(const TriangleMesh& mesh, MeshReport& r) {
    const EdgeTable edges(mesh);
    count_edges(mesh, edges, r);
    r.nonmanifold_vertices = count_nonmanifold_vertices(mesh, edges);
    r.components = count_components(mesh);
    const std::vector<Hole> holes = find_holes(mesh, edges);
    r.holes = holes.size();
    for (std::size_t i = 0; i < std::min<std::size_t>(16, holes.size()); ++i) r.hole_places.push_back(holes[i].center);
    if (r.closed() && r.manifold()) {
        const auto euler =
            static_cast<long>(mesh.vertices.size() + mesh.triangles.size()) - static_cast<long>(edges.size());
        r.genus = static_cast<long>(r.components) - euler / 2;
    }
}

/// Whether each shell of closed surfaces that do not cross is either outermost or a cavity, so that the winding number
/// is 1 inside and 0 outside. As nothing crosses, the winding number of all other shells is the same all over a shell:
/// one vertex of it decides, however close the others come.
bool shells_are_nested_as_cavities(const TriangleMesh& mesh, const WindingNumber& of_all) {
    const std::vector<TriangleMesh> shells = split_components(mesh);
    if (shells.size() == 1) return true;  // oriented outward before
    for (const TriangleMesh& shell : shells) {
        const Vec3 place = shell.vertices[shell.triangles[0][0]];
        const double others = of_all(place) - WindingNumber(shell)(place);
        const double expected = signed_volume(shell) > 0 ? 0 : 1;
        if (std::abs(others - expected) > 0.5) return false;
    }
    return true;
}

/// Where the mesh is open or not orientable, for a refusal.
std::string worst_place(const MeshReport& r) {
    if (!r.hole_places.empty())
        return ", largest of " + count(r.holes, "hole", "holes") + " around " + text(r.hole_places[0]) + ",";
    if (!r.intersection_places.empty()) return ", crossing itself at " + text(r.intersection_places[0]) + ",";
    return ", around " + text(r.lower + 0.5 * (r.upper - r.lower)) + ",";
}

/// Volume and verdict.
void decide(CheckedMesh& checked) {
    MeshReport& r = checked.report;
    const WindingNumber winding_number(checked.mesh);
    const Vec3 size = r.upper - r.lower;
    checked.closed_and_simple = r.closed() && r.nonmanifold_edges == 0 && r.oriented() && r.self_intersections == 0 &&
                                shells_are_nested_as_cavities(checked.mesh, winding_number);
    double doubtful = 0;
    if (checked.closed_and_simple) {
        r.volume = std::abs(r.signed_volume);
    } else {
        const WindingVolume measured = winding_volume(checked.mesh, winding_number);
        r.volume = measured.volume;
        doubtful = measured.doubtful;
    }
    if (!(r.volume > flat_volume * r.area * norm(size))) {
        r.volume = 0;
        r.refusal = "the surface" + worst_place(r) + " encloses no volume: close it, or give a sheet some thickness";
    } else if (doubtful > largest_doubtful_share * r.volume) {
        r.refusal = "the surface" + worst_place(r) + " does not tell inside from outside (by the winding number, " +
                    text(100 * doubtful / r.volume) +
                    " % of the inside is in doubt): close the hole in the program that made the mesh";
    }
    r.can_be_simulated = r.refusal.empty();
    if (r.can_be_simulated && !checked.closed_and_simple && r.closed() && r.self_intersections == 0)
        r.repairs.push_back(
            "shells that lie within each other's solid, or faces inside of it, count once, by the winding number");
    if (r.can_be_simulated && !r.closed())
        r.repairs.push_back(count(r.holes, "hole", "holes") + " closed by the winding number, the largest around " +
                            text(r.hole_places[0]));
    if (r.can_be_simulated && r.self_intersections > 0)
        r.repairs.push_back(
            "overlaps count once, by the winding number: " + count(r.self_intersections, "pair", "pairs") +
            " of triangles cross, for one at " + text(r.intersection_places[0]));
}

}  // namespace

CheckedMesh check_and_repair(const TriangleMesh& mesh) {
    CheckedMesh checked;
    MeshReport& r = checked.report;
    r.vertices = mesh.vertices.size();
    r.triangles = mesh.triangles.size();
    r.refusal = unusable_numbers(mesh);
    if (!r.refusal.empty()) return checked;

    checked.mesh = mesh;
    checked.vertex_of = weld_vertices(checked.mesh, r);
    drop_useless_triangles(checked.mesh, r);
    if (checked.mesh.triangles.empty()) {
        r.refusal = "no triangle near " + text(mesh.vertices[mesh.triangles[0][0]]) +
                    " has any area: the mesh is a point or a line";
        return checked;
    }
    drop_unused_vertices(checked.mesh, checked.vertex_of, r);  // those of the triangles just dropped
    orient_triangles(checked.mesh, r);

    const Bounds box = bounding_box(checked.mesh);
    r.lower = box.lower;
    r.upper = box.upper;
    r.area = surface_area(checked.mesh);
    r.signed_volume = signed_volume(checked.mesh);
    measure_topology(checked.mesh, r);
    const SelfIntersections crossings = find_self_intersections(checked.mesh, build_bvh(checked.mesh));
    r.self_intersections = crossings.pairs;
    r.intersection_places = crossings.places;
    describe_repairs(r);
    decide(checked);
    return checked;
}

MeshReport check_mesh(const TriangleMesh& mesh) { return check_and_repair(mesh).report; }

}  // namespace phyxel
