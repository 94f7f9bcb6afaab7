#pragma once

#include <array>

#include "geometry/bvh.h"

namespace phyxel {

/// The point of a triangle that is nearest to some place: sum of weights times corners, weights >= 0 of sum 1. Those of
/// corners that it does not depend on are exactly 0.
struct TrianglePoint {
    Vec3 position;
    std::array<double, 3> weights;
};

TrianglePoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// The point of a surface that is nearest to some place.
struct SurfaceFoot {
    std::uint32_t triangle;
    TrianglePoint point;
    double distance;
};

/// The nearest point within `reach` of `p`, of the triangles that `tree` is over; `triangle` is `no_triangle` when
/// there is none. Of several equally near ones, that of the lowest triangle.
SurfaceFoot closest_point(const TriangleMesh& mesh, const Bvh& tree, const Vec3& p, double reach);

inline constexpr std::uint32_t no_triangle = 0xffffffff;

}  // namespace phyxel
