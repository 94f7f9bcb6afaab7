#pragma once

#include "geometry/mesh_check.h"
#include "model/model.h"

namespace phyxel {

/// The surface that meets obstacles and other bodies, of triangles small enough to bend as the body does.
struct ContactSurface {
    TriangleMesh mesh;                 ///< lattice frame; no edge is longer than three quarters of a lattice box
    std::vector<std::uint32_t> cells;  ///< [vertices] that carry them
    /// Whether points of other bodies can be told inside from outside, so that the surface keeps them out. The points
    /// of one that cannot, an open one, are kept out of others all the same.
    bool has_inside = true;
};

/// The body's own surface, `body` in rest space.
ContactSurface contact_surface(const Model& model, const TriangleMesh& body, const Threads& threads);

/// Another surface `given`, in rest space, each point of which goes with the part of the body nearest to it. Throws
/// `Error` when one is further outside of the body than the support of its nodes.
ContactSurface contact_surface(const Model& model, const TriangleMesh& body, const CheckedMesh& given,
                               const Threads& threads);

}  // namespace phyxel
