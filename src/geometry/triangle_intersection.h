#pragma once

#include <optional>
#include <vector>

#include "geometry/bvh.h"

namespace phyxel {

/// Where pairs of a mesh's triangles cross.
struct SelfIntersections {
    std::size_t pairs = 0;
    std::vector<Vec3> places;  ///< of at most 16 pairs, spread over all
    bool complete = true;      ///< false: the search stopped at `most_pairs`
};

/// The search stops there: such a mesh is a tangle anyhow.
constexpr std::size_t most_intersecting_pairs = 100000;

/// Depths below this times the longest side of the bounding box are contact, not crossing.
constexpr double contact_tolerance = 1e-9;

/// A point where two triangles cross, or none. Crossing means that an edge of one passes from one side of the other to
/// the other side within it, deeper than `tolerance` [length]; or that both lie in one plane, face the same way and
/// overlap. Touching is no crossing: a vertex or an edge in the other's plane, faces back to back, common vertices and
/// common edges.
std::optional<Vec3> intersect_triangles(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double tolerance);

SelfIntersections find_self_intersections(const TriangleMesh& mesh, const Bvh& bvh);

}  // namespace phyxel
