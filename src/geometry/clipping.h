#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/threads.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

/// A solid cut into the octants of a lattice: volumes, centroids and boundary of every octant's part of it.
/// Everything is in the lattice frame: octant (i, j, k) is the box [i, i + 1) x [j, j + 1) x [k, k + 1), times the
/// edge `pitch` of an octant; a node of the lattice of spacing 2 pitch owns the eight octants that touch it.

namespace phyxel {

class WindingNumber;
struct SubVoxels;

/// The part of the solid inside one octant.
struct Octant {
    std::array<int, 3> index{};
    double volume = 0;  ///< [m^3]
    Vec3 centroid;      ///< [m] first moment / volume
};

/// A piece of surface, as a one-point quadrature that is exact for linear fields.
struct SurfacePoint {
    static constexpr std::uint32_t no_triangle = 0xffffffff;

    Vec3 position;                         ///< [m] centroid of the piece
    Vec3 area;                             ///< [m^2] outward unit normal times area
    std::uint32_t triangle = no_triangle;  ///< that it was cut from
};

struct ClippedVolume {
    double pitch = 0;             ///< [m] edge of an octant
    std::vector<Octant> octants;  ///< with volume > 0, sorted by (i, j, k)
    /// Closed boundary of the clipped region: sum area = 0, sum position (x) area = volume times the identity.
    std::vector<SurfacePoint> boundary;
    double volume = 0;  ///< [m^3] sum over the octants
    /// What the octants were made of where the winding number decided; finding it takes seconds. Null for closed
    /// meshes.
    std::shared_ptr<const SubVoxels> sub_voxels;
    double leak = 0;  ///< largest projected area left open below a column of octants / pitch^2; 0 (1e-13) when closed
};

/// Octants of a closed mesh oriented outward, exactly: volumes add up to the mesh's volume, first moments likewise, to
/// 1e-12. Shells inside others that are oriented inward are cavities. Where the surface overlaps itself the overlap
/// counts as often as it is covered; an open mesh shows as a `leak`. Time and memory grow with the octants of the
/// bounding box: the caller sees to it that there are not too many.
ClippedVolume clip_closed(const TriangleMesh& mesh, double pitch, const Threads& threads);

/// Octants of the region whose winding number exceeds 1/2, for open and self-intersecting meshes: an overlap counts
/// once, a hole is closed. Octants near the surface consist of 4 x 4 x 4 sub-voxels, each whole or empty by the winding
/// number at its centre, and `volume` and `boundary` are those of the sub-voxels.
ClippedVolume clip_by_winding_number(const TriangleMesh& mesh, const WindingNumber& winding, double pitch,
                                     const Threads& threads);

/// The triangles of `mesh`, cut along the planes of the octants; pieces of one plane in one octant are one point.
std::vector<SurfacePoint> cut_surface(const TriangleMesh& mesh, double pitch);

}  // namespace phyxel
