#pragma once

#include <cstdint>
#include <vector>

#include "phyxel/mesh.h"

namespace phyxel {

/// Axis-aligned box; empty until something is added.
struct Bounds {
    Vec3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};

    void add(const Vec3& point);
    void add(const Bounds& box);
    /// Moves every side out.
    void grow(double by) { lower -= Vec3{by, by, by}, upper += Vec3{by, by, by}; }
    Vec3 size() const { return upper - lower; }
    Vec3 center() const { return lower + 0.5 * (upper - lower); }
    bool overlaps(const Bounds& other) const;
};

/// Bounding box of the vertices that triangles use.
Bounds bounding_box(const TriangleMesh& mesh);

/// Box of one triangle.
Bounds triangle_box(const TriangleMesh& mesh, std::size_t triangle);

/// Bounding volume hierarchy over the triangles of a mesh: a binary tree, split at the median along the longest side of
/// the centroids' box. Depends on the mesh alone, so every walk meets the triangles in the same order.
struct Bvh {
    struct Node {
        Bounds box;
        std::uint32_t begin = 0, end = 0;  ///< triangles `order[begin, end)` lie below this node
        std::uint32_t right = 0;           ///< right child; the left one is the next node; 0: a leaf
        bool leaf() const { return right == 0; }
    };
    std::vector<Node> nodes;           ///< [nodes] depth first, root first; empty for a mesh without triangles
    std::vector<std::uint32_t> order;  ///< [triangles] triangle ids, leaf by leaf
};

Bvh build_bvh(const TriangleMesh& mesh, std::size_t leaf_size = 4);

}  // namespace phyxel
