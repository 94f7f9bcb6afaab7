#include "geometry/mesh_topology.h"

#include <algorithm>
#include <numeric>

namespace phyxel {

EdgeTable::EdgeTable(const TriangleMesh& mesh) {
    const auto half_edges = static_cast<HalfEdge>(3 * mesh.triangles.size());
    const auto lower_end = [&](HalfEdge h) { return std::min(origin_of(mesh, h), target_of(mesh, h)); };
    const auto upper_end = [&](HalfEdge h) { return std::max(origin_of(mesh, h), target_of(mesh, h)); };

    // Sorted by the lower end by counting, then each short run by the upper end
    std::vector<std::size_t> run(mesh.vertices.size() + 1, 0);
    for (HalfEdge h = 0; h < half_edges; ++h) ++run[lower_end(h) + 1];
    std::partial_sum(run.begin(), run.end(), run.begin());
    std::vector<std::size_t> next(run.begin(), run.end());
    half_edges_.resize(half_edges);
    for (HalfEdge h = 0; h < half_edges; ++h) half_edges_[next[lower_end(h)]++] = h;
    for (std::size_t v = 0; v + 1 < run.size(); ++v)
        std::sort(half_edges_.begin() + static_cast<std::ptrdiff_t>(run[v]),
                  half_edges_.begin() + static_cast<std::ptrdiff_t>(run[v + 1]), [&](HalfEdge g, HalfEdge h) {
                      return upper_end(g) != upper_end(h) ? upper_end(g) < upper_end(h) : g < h;
                  });
    for (std::size_t i = 0; i < half_edges_.size(); ++i) {
        const HalfEdge h = half_edges_[i];
        if (i == 0 || lower_end(half_edges_[i - 1]) != lower_end(h) || upper_end(half_edges_[i - 1]) != upper_end(h))
            begins_.push_back(i);
    }
    begins_.push_back(half_edges_.size());
}

DisjointSets::DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t DisjointSets::find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
}

void DisjointSets::unite(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    if (i != j) parent_[std::max(i, j)] = std::min(i, j);
}

std::vector<Hole> find_holes(const TriangleMesh& mesh, const EdgeTable& edges) {
    // The boundary edges at every vertex
    struct End {
        std::uint32_t vertex, other, edge;
    };
    std::vector<End> ends;
    std::uint32_t boundary_edges = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges.sides(e).size() != 1) continue;
        const HalfEdge h = edges.sides(e)[0];
        ends.push_back({origin_of(mesh, h), target_of(mesh, h), boundary_edges});
        ends.push_back({target_of(mesh, h), origin_of(mesh, h), boundary_edges++});
    }
    std::sort(ends.begin(), ends.end(),
              [](const End& a, const End& b) { return a.vertex != b.vertex ? a.vertex < b.vertex : a.edge < b.edge; });

    // Follow them around
    std::vector<char> used(boundary_edges, 0);
    std::vector<Hole> holes;
    for (const End& start : ends) {
        if (used[start.edge]) continue;
        Hole hole;
        for (const End* end = &start; end != nullptr;) {
            used[end->edge] = 1;
            const Vec3 &a = mesh.vertices[end->vertex], &b = mesh.vertices[end->other];
            hole.length += norm(b - a);
            hole.center += norm(b - a) * 0.5 * (a + b);
            const std::uint32_t at = end->other;
            auto candidate = std::lower_bound(ends.begin(), ends.end(), at,
                                              [](const End& e, std::uint32_t v) { return e.vertex < v; });
            while (candidate != ends.end() && candidate->vertex == at && used[candidate->edge]) ++candidate;
            end = candidate != ends.end() && candidate->vertex == at ? &*candidate : nullptr;
        }
        hole.center /= hole.length;
        holes.push_back(hole);
    }
    std::stable_sort(holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.length > b.length; });
    return holes;
}

std::size_t count_components(const TriangleMesh& mesh) {
    DisjointSets sets(mesh.vertices.size());
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& [a, b, c] : mesh.triangles) {
        sets.unite(a, b);
        sets.unite(a, c);
        used[a] = used[b] = used[c] = 1;
    }
    std::size_t components = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) components += used[v] && sets.find(v) == v;
    return components;
}

std::vector<TriangleMesh> split_components(const TriangleMesh& mesh) {
    constexpr std::uint32_t none = 0xffffffff;
    DisjointSets sets(mesh.vertices.size());
    for (const auto& [a, b, c] : mesh.triangles) sets.unite(a, b), sets.unite(a, c);
    std::vector<TriangleMesh> parts;
    std::vector<std::uint32_t> part_of(mesh.vertices.size(), none), local(mesh.vertices.size(), none);
    for (const Triangle& t : mesh.triangles) {
        std::uint32_t& part = part_of[sets.find(t[0])];
        if (part == none) part = static_cast<std::uint32_t>(parts.size()), parts.emplace_back();
        TriangleMesh& target = parts[part];
        Triangle moved{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            std::uint32_t& v = local[t[corner]];
            if (v == none) {
                v = static_cast<std::uint32_t>(target.vertices.size());
                target.vertices.push_back(mesh.vertices[t[corner]]);
            }
            moved[corner] = v;
        }
        target.triangles.push_back(moved);
    }
    return parts;
}

std::size_t count_nonmanifold_vertices(const TriangleMesh& mesh, const EdgeTable& edges) {
    // Corners at a vertex are joined across edges of two triangles; a vertex with more than one set is no fan
    DisjointSets corners(3 * mesh.triangles.size());
    const auto corner_at = [&](std::uint32_t triangle, std::uint32_t vertex) {
        const Triangle& t = mesh.triangles[triangle];
        return 3 * triangle + (t[0] == vertex ? 0u : t[1] == vertex ? 1u : 2u);
    };
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto sides = edges.sides(e);
        if (sides.size() != 2) continue;
        for (const std::uint32_t v : {origin_of(mesh, sides[0]), target_of(mesh, sides[0])})
            corners.unite(corner_at(sides[0] / 3, v), corner_at(sides[1] / 3, v));
    }
    std::vector<std::uint32_t> fans(mesh.vertices.size(), 0);
    for (std::uint32_t c = 0; c < 3 * mesh.triangles.size(); ++c) fans[origin_of(mesh, c)] += corners.find(c) == c;
    return static_cast<std::size_t>(std::count_if(fans.begin(), fans.end(), [](std::uint32_t f) { return f > 1; }));
}

}  // namespace phyxel
