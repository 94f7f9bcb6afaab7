#pragma once

#include <vector>

#include "phyxel/mesh.h"

namespace phyxel {

/// A mesh as the rest of the library takes it.
struct CheckedMesh {
    TriangleMesh mesh;  ///< welded, without useless triangles, oriented; empty when not even that could be done
    MeshReport report;
    /// Closed, manifold along its edges, oriented, not crossing itself, and each shell either outermost or a cavity:
    /// the winding number is 1 inside and 0 outside, and sums over triangles (volumes, moments) are exact.
    bool closed_and_simple = false;
    /// [vertices as read] the vertex of `mesh` at the same place; UINT32_MAX where no triangle used it.
    std::vector<std::uint32_t> vertex_of;
};

/// Checks a mesh, mends it, and decides whether it can be simulated:
///
/// - it has a size that double precision can work with, and a volume;
/// - less than half of the region of winding number above 1/2 is doubtful, that is below 0.7. A planar hole is closed
/// by
///   its plane whatever its size (there the winding number is exactly 1/2), but where most of the inside is doubtful,
///   it is the holes' shape that made it, not the surface's.
///
/// Never throws; a mesh that cannot be simulated has `report.refusal`.
CheckedMesh check_and_repair(const TriangleMesh& mesh);

}  // namespace phyxel
