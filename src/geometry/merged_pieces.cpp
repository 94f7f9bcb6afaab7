#include "geometry/merged_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace phyxel {
namespace {

constexpr double flat = 1e-9;  ///< sine of the angle between planes that count as one

bool parallel(const Vec3& a, const Vec3& b) { return dot(a, b) > 0 && norm(cross(a, b)) <= flat * dot(a, b); }

/// [triangles] whether an edge neighbour lies in the same plane.
std::vector<char> coplanar_with_neighbour(const TriangleMesh& mesh) {
    struct Edge {
        std::uint32_t a, b, triangle;
        bool operator<(const Edge& e) const { return std::array{a, b, triangle} < std::array{e.a, e.b, e.triangle}; }
    };
    std::vector<Edge> edges;
    std::vector<Vec3> area;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& v = mesh.triangles[t];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = v[c], b = v[(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), t});
        }
        area.push_back(cross(mesh.vertices[v[1]] - mesh.vertices[v[0]], mesh.vertices[v[2]] - mesh.vertices[v[0]]));
    }
    std::sort(edges.begin(), edges.end());
    std::vector<char> found(mesh.triangles.size());
    for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
        if (edges[e].a != edges[e + 1].a || edges[e].b != edges[e + 1].b) continue;
        if (parallel(area[edges[e].triangle], area[edges[e + 1].triangle]))
            found[edges[e].triangle] = found[edges[e + 1].triangle] = 1;
    }
    return found;
}

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
}

}  // namespace

std::vector<SurfacePoint> merge_coplanar(const std::vector<SurfacePoint>& pieces, const TriangleMesh& mesh,
                                         double pitch) {
    const std::vector<char> candidate = coplanar_with_neighbour(mesh);
    if (std::find(candidate.begin(), candidate.end(), 1) == candidate.end()) return pieces;

    // Pieces that meet at a vertex of the mesh inside of an octant's neighbourhood, or share an edge across it: those
    // of triangles with a common vertex. The first of each group stands for it.
    std::vector<std::uint32_t> parent(pieces.size());
    std::map<std::array<std::int64_t, 4>, std::vector<std::uint32_t>> at_vertex;
    for (std::uint32_t p = 0; p < pieces.size(); ++p) {
        parent[p] = p;
        if (pieces[p].triangle == SurfacePoint::no_triangle || !candidate[pieces[p].triangle]) continue;
        // A piece that lies in a plane of octants counts to the solid's side of it.
        const Vec3 inside = pieces[p].position - 1e-3 * pitch * normalized(pieces[p].area);
        std::array<std::int64_t, 4> key{};
        for (std::size_t d = 0; d < 3; ++d) key[d] = static_cast<std::int64_t>(std::floor(inside[d] / pitch));
        for (std::uint32_t vertex : mesh.triangles[pieces[p].triangle]) {
            key[3] = vertex;
            auto& others = at_vertex[key];
            for (std::uint32_t o : others)
                if (parallel(pieces[o].area, pieces[p].area)) {
                    const std::uint32_t a = root_of(parent, o), b = root_of(parent, p);
                    parent[std::max(a, b)] = std::min(a, b);
                    break;
                }
            others.push_back(p);
        }
    }

    std::vector<SurfacePoint> merged;
    std::vector<std::uint32_t> place(pieces.size());
    std::vector<double> weight;
    for (std::uint32_t p = 0; p < pieces.size(); ++p) {
        const std::uint32_t root = root_of(parent, p);
        const double area = norm(pieces[p].area);
        if (root == p) {
            place[p] = static_cast<std::uint32_t>(merged.size());
            merged.push_back({area * pieces[p].position, pieces[p].area, pieces[p].triangle});
            weight.push_back(area);
            continue;
        }
        SurfacePoint& sum = merged[place[root]];
        sum.position += area * pieces[p].position;
        sum.area += pieces[p].area;
        weight[place[root]] += area;
    }
    for (std::size_t i = 0; i < merged.size(); ++i) merged[i].position /= weight[i];
    return merged;
}

}  // namespace phyxel
