#pragma once

#include <vector>

#include "geometry/clipping.h"

namespace phyxel {

/// Joins the pieces of a cut surface that lie in one octant and one plane and hang together, into one point at their
/// common centroid: still exact for linear fields, with the same sums of area and of first moments, and no trace of
/// how a flat face happened to be triangulated. (A beam with one diagonal across each face would drift sideways.)
/// `mesh`: what the pieces were cut from, vertices welded.
std::vector<SurfacePoint> merge_coplanar(const std::vector<SurfacePoint>& pieces, const TriangleMesh& mesh,
                                         double pitch);

}  // namespace phyxel
