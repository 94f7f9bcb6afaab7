#pragma once

#include "phyxel/mesh.h"

namespace phyxel {

/// Sum of the triangles' areas.
double surface_area(const TriangleMesh& mesh);

/// Volume enclosed, by the divergence theorem: sum of a.(b x c) / 6, about the first vertex so that a mesh far from the
/// origin keeps its digits. Negative when the surface is inward. Exact only for a closed surface.
double signed_volume(const TriangleMesh& mesh);

}  // namespace phyxel
