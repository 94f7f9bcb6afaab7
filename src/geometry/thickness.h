#pragma once

#include "phyxel/mesh.h"

namespace phyxel {

/// How thin a body is where it is thinnest.
struct Thickness {
    double thinnest = 0;  ///< in the mesh's unit; infinite when no ray met an opposite side
    Vec3 place;           ///< on the surface, where that was found
};

/// Local thickness, as the distance from a triangle's centroid to the opposite side, straight inward. The result is the
/// first percentile by area, and rays that meet the opposite side at more than 60 degrees from its normal do not count:
/// so the surface next to a sharp convex edge does not pass for a thin part. Samples at most 5000 triangles, evenly.
/// For an outward surface, as `check_and_repair` leaves it.
Thickness local_thickness(const TriangleMesh& mesh);

}  // namespace phyxel
