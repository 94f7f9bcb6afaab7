#pragma once

#include "geometry/winding_number.h"

namespace phyxel {

/// The region whose winding number is above 1/2, measured.
struct WindingVolume {
    double volume = 0;
    double doubtful = 0;  ///< part of it whose winding number is below 0.7: near large holes
};

/// Measures the region on an octree over the mesh's bounding box, whose cells are refined down to 1/32 of the box's
/// sides where the surface passes or the winding number is within 0.25 of 1/2. The last cells are cut by the nearest
/// triangle's plane. Volumes come out to within 1 %. Finer cells were tried: 1/64 takes five times
/// as long, half a second and more for an open scan.
WindingVolume winding_volume(const TriangleMesh& mesh, const WindingNumber& winding_number);

}  // namespace phyxel
