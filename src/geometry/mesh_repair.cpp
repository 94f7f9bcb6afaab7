#include "geometry/mesh_repair.h"

#include <algorithm>
#include <array>

#include "geometry/bvh.h"
#include "geometry/mesh_topology.h"

namespace phyxel {

namespace {

/// Unites the vertices that `key` maps to the same value.
template <class Key>
void unite_equal(std::vector<std::uint32_t>& vertices, DisjointSets& sets, Key&& key) {
    std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    for (std::size_t i = 1; i < vertices.size(); ++i)
        if (key(vertices[i - 1]) == key(vertices[i])) sets.unite(vertices[i - 1], vertices[i]);
}

/// Sets of `vertices` at the same place.
DisjointSets coincident_vertices(const TriangleMesh& mesh, std::vector<std::uint32_t> vertices) {
    DisjointSets sets(mesh.vertices.size());

    // Equal to the bit
    unite_equal(vertices, sets, [&](std::uint32_t v) {
        const Vec3& x = mesh.vertices[v];
        return std::array{x.x, x.y, x.z};
    });
    std::erase_if(vertices, [&](std::uint32_t v) { return sets.find(v) != v; });

    // Nearly equal: two points within the tolerance share a cell of twice its size in at least one of eight grids, each
    // shifted by half a cell along some of the axes
    const Bounds box = bounding_box(mesh);
    const Vec3 size = box.size();
    const double cell = 2 * weld_tolerance * std::max({size.x, size.y, size.z});
    if (!(cell > 0)) return sets;
    std::vector<std::array<std::int64_t, 3>> cells(mesh.vertices.size());
    for (unsigned grid = 0; grid < 8; ++grid) {
        for (const std::uint32_t v : vertices)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double shift = grid >> axis & 1 ? 0.5 : 0.0;
                cells[v][axis] = std::llround((mesh.vertices[v][axis] - box.lower[axis]) / cell + shift);
            }
        unite_equal(vertices, sets, [&](std::uint32_t v) { return cells[v]; });
    }
    return sets;
}

Triangle sorted(Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
}

/// Whether a triangle's own order is an even permutation of its sorted one: tells its two senses apart.
bool is_even(const Triangle& t) { return (t[0] < t[1]) == ((t[1] < t[2]) == (t[0] < t[2])); }

/// Keeps the triangles that `keep` marks, and the parts' ranges in step.
void keep_triangles(TriangleMesh& mesh, const std::vector<char>& keep) {
    std::vector<std::size_t> new_index(mesh.triangles.size() + 1, 0);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        new_index[t] = kept;
        if (keep[t]) mesh.triangles[kept++] = mesh.triangles[t];
    }
    new_index.back() = kept;
    mesh.triangles.resize(kept);
    for (TriangleMesh::Part& part : mesh.parts) part = {part.name, new_index[part.begin], new_index[part.end]};
}

}  // namespace

std::vector<std::uint32_t> weld_vertices(TriangleMesh& mesh, MeshReport& report) {
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) used[v] = 1;
    std::vector<std::uint32_t> in_use;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
        if (used[v]) in_use.push_back(v);
    report.unused_vertices += mesh.vertices.size() - in_use.size();
    DisjointSets sets = coincident_vertices(mesh, in_use);

    std::vector<std::uint32_t> new_index(mesh.vertices.size(), UINT32_MAX);
    std::vector<Vec3> vertices;
    for (const std::uint32_t v : in_use) {
        const std::uint32_t first = sets.find(v);  // the smallest of its set: its new number is known
        if (first == v) {
            new_index[v] = static_cast<std::uint32_t>(vertices.size());
            vertices.push_back(mesh.vertices[v]);
        } else {
            new_index[v] = new_index[first];
            ++report.duplicate_vertices;
        }
    }
    mesh.vertices = std::move(vertices);
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) v = new_index[v];
    return new_index;
}

void drop_useless_triangles(TriangleMesh& mesh, MeshReport& report) {
    std::vector<char> keep(mesh.triangles.size(), 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        keep[t] = a != b && b != c && c != a;
        report.degenerate_triangles += !keep[t];
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (keep[t]) order.push_back(t);
    const auto key = [&](std::uint32_t t) { return std::pair(sorted(mesh.triangles[t]), is_even(mesh.triangles[t])); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t s, std::uint32_t t) {
        const auto ks = key(s), kt = key(t);
        return ks != kt ? ks < kt : s < t;
    });
    for (std::size_t i = 1; i < order.size(); ++i)
        if (key(order[i - 1]) == key(order[i])) {
            keep[order[i]] = 0;
            ++report.duplicate_triangles;
        }
    keep_triangles(mesh, keep);
}

void drop_unused_vertices(TriangleMesh& mesh, std::vector<std::uint32_t>& vertex_of, MeshReport& report) {
    std::vector<std::uint32_t> new_index(mesh.vertices.size(), UINT32_MAX);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) new_index[v] = 0;
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (new_index[v] == UINT32_MAX) continue;
        mesh.vertices[kept] = mesh.vertices[v];
        new_index[v] = kept++;
    }
    report.unused_vertices += mesh.vertices.size() - kept;
    mesh.vertices.resize(kept);
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) v = new_index[v];
    for (std::uint32_t& v : vertex_of)
        if (v != UINT32_MAX) v = new_index[v];
}

}  // namespace phyxel
