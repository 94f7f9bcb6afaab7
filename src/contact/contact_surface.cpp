#include "contact/contact_surface.h"

#include <algorithm>
#include <limits>

#include "base/format.h"
#include "contact/moving_surface.h"
#include "geometry/refined_mesh.h"
#include "phyxel/error.h"
#include "surface/embedded_surface.h"

namespace phyxel {
namespace {

/// Edges of the surface are no longer than this share of the lattice's boxes.
constexpr double longest_edge = 0.75;

/// Points closer to the body's surface than this share of a box are on it.
constexpr double on_surface = 1e-6;

TriangleMesh fine_mesh(const Sampling& s, const TriangleMesh& mesh) {
    return refined(to_lattice(mesh, s.frame), longest_edge * s.pitch);
}

/// The body's own surface, lattice frame.
class OwnSurface {
public:
    OwnSurface(const Sampling& sampling, const TriangleMesh& body)
        : mesh_(to_lattice(body, sampling.frame)),
          tree_(build_bvh(mesh_)),
          triangles_(mesh_.triangles, mesh_.vertices.size()),
          least_(on_surface * sampling.pitch) {}

    /// The point of it that is nearest to a place, and how far the place is outside; 0 on the surface and inside.
    struct Nearest {
        Vec3 position, outward;
        double outside;
    };
    Nearest nearest(const Vec3& place) const {
        const SurfaceFoot foot = closest_point(mesh_, tree_, place, std::numeric_limits<double>::infinity());
        const Vec3 outward = triangles_.outward(mesh_.vertices, foot);
        const bool outside = foot.distance > least_ && !(dot(place - foot.point.position, outward) < 0);
        return {foot.point.position, outward, outside ? foot.distance : 0};
    }
    std::vector<Nearest> nearest(const std::vector<Vec3>& places, const Threads& threads) const {
        std::vector<Nearest> list(places.size());
        threads.for_each(list.size(), 64, [&](std::size_t v) { list[v] = nearest(places[v]); });
        return list;
    }

private:
    TriangleMesh mesh_;
    Bvh tree_;
    MovingSurface triangles_;
    double least_;
};

/// The vertex of the mesh as given that became `welded`.
std::size_t given_vertex(const CheckedMesh& given, std::size_t welded) {
    const auto found = std::find(given.vertex_of.begin(), given.vertex_of.end(), welded);
    return static_cast<std::size_t>(found - given.vertex_of.begin());
}

/// `places` [points] in the lattice frame, those of the vertices of `given` first.
void refuse_out_of_reach(const Model& model, const CheckedMesh& given, const std::vector<Vec3>& places,
                         const std::vector<OwnSurface::Nearest>& nearest) {
    const auto less = [](const auto& a, const auto& b) { return a.outside < b.outside; };
    const auto furthest = std::max_element(nearest.begin(), nearest.end(), less);
    const double reach = model.approximation.support;
    if (furthest->outside < reach) return;
    const auto v = static_cast<std::size_t>(furthest - nearest.begin());
    const bool is_vertex = v < given.mesh.vertices.size();
    throw Error((is_vertex ? "vertex " + std::to_string(given_vertex(given, v)) : std::string("the surface")) + " at " +
                format_point(model.sampling.frame.to_rest(places[v])) + " is " + format_number(furthest->outside) +
                " m away from the body, where none of its nodes carries it. The contact surface must lie on or near "
                "the body, less than " +
                format_number(reach) + " m outside of it; scale, rotation and translation of the body act on both");
}

}  // namespace

ContactSurface contact_surface(const Model& model, const TriangleMesh& body, const Threads& threads) {
    const Sampling& s = model.sampling;
    ContactSurface surface{fine_mesh(s, body), {}, true};
    const std::vector<Vec3> normals = vertex_normals(surface.mesh);
    surface.cells.resize(normals.size());
    threads.for_each(normals.size(), 256,
                     [&](std::size_t v) { surface.cells[v] = s.locate(surface.mesh.vertices[v], normals[v]); });
    return surface;
}

ContactSurface contact_surface(const Model& model, const TriangleMesh& body, const CheckedMesh& given,
                               const Threads& threads) {
    const Sampling& s = model.sampling;
    const OwnSurface own(s, body);
    // Vertices by themselves first: a surface of another unit would be cut into no end of triangles.
    const std::vector<Vec3> vertices = to_lattice(given.mesh, s.frame).vertices;
    refuse_out_of_reach(model, given, vertices, own.nearest(vertices, threads));

    const MeshReport& report = given.report;
    ContactSurface surface{
        fine_mesh(s, given.mesh), {}, report.closed() && report.oriented() && report.can_be_simulated};
    const std::vector<Vec3>& places = surface.mesh.vertices;
    const std::vector<OwnSurface::Nearest> nearest = own.nearest(places, threads);
    refuse_out_of_reach(model, given, places, nearest);

    const std::vector<Vec3> normals = vertex_normals(surface.mesh);
    surface.cells.resize(places.size());
    threads.for_each(places.size(), 256, [&](std::size_t v) {
        // On the body's surface the given one counts, as if it were the body's own; an open one may face inward.
        const bool agrees = dot(normals[v], nearest[v].outward) > 0;
        surface.cells[v] = s.locate(nearest[v].outside > 0 ? nearest[v].position : places[v],
                                    agrees ? normals[v] : nearest[v].outward);
    });
    return surface;
}

}  // namespace phyxel
