#pragma once

#include "geometry/closest_point.h"
#include "geometry/winding_number.h"

namespace phyxel {

/// Signed distance to a surface, negative where its winding number is above 1/2. Const and safe to call from many
/// threads; the value depends on the mesh and the point alone.
class SurfaceDistance {
public:
    explicit SurfaceDistance(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(build_bvh(mesh_)), winding_(mesh_) {}

    /// Exact within `reach` of the surface, +-`reach` beyond.
    double operator()(const Vec3& point, double reach) const;

private:
    TriangleMesh mesh_;
    Bvh tree_;
    WindingNumber winding_;
};

}  // namespace phyxel
