#pragma once

#include "geometry/closest_point.h"

namespace phyxel {

/// The triangles of a surface whose vertices move.
class MovingSurface {
public:
    MovingSurface() = default;
    MovingSurface(std::vector<Triangle> triangles, std::size_t vertices);

    const std::vector<Triangle>& triangles() const { return triangles_; }

    /// The outward direction at a foot point, of unit length: the triangle's normal, the mean of two on an edge, and at
    /// a vertex that of all around weighted by their angles. With it the sign of a distance is right wherever the foot
    /// is (Baerentzen and Aanaes 2005). `vertices` are the places now.
    Vec3 outward(const std::vector<Vec3>& vertices, const SurfaceFoot& foot) const;

private:
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> offset_{0}, fan_;  ///< [vertices + 1] triangles around each vertex
};

}  // namespace phyxel
