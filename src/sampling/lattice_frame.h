#pragma once

#include "phyxel/body.h"
#include "phyxel/mesh.h"

namespace phyxel {

/// The coordinate system of a body's node lattice: node planes at whole multiples of the node pitch. Geometry is
/// clipped in it, because there every cutting plane is an axis plane; the physics lives in rest space.
struct LatticeFrame {
    Mat3 rotation = Mat3::identity();  ///< columns: the lattice axes in rest space
    Vec3 origin{};                     ///< in rest space [m]

    Vec3 to_rest(const Vec3& p) const { return rotation * p + origin; }
    Vec3 to_lattice(const Vec3& X) const { return transpose(rotation) * (X - origin); }
    Vec3 direction_to_rest(const Vec3& d) const { return rotation * d; }
    Vec3 direction_to_lattice(const Vec3& d) const { return transpose(rotation) * d; }
};

/// Rotation matrix of `rotation`; the identity for zero degrees.
Mat3 rotation_matrix(const AxisAngle& rotation);

/// Places a lattice of node pitch `pitch` against a mesh in rest space. Axes: the body's (`body_rotation`), turned by
/// `lattice_rotation`. Along each axis the planes fall on both faces of the bounding box where the pitch divides the
/// side (to 1e-4 of a pitch), and overhang both equally elsewhere.
LatticeFrame place_lattice(const TriangleMesh& mesh, const Mat3& body_rotation, const AxisAngle& lattice_rotation,
                           double pitch);

/// The mesh in the coordinates of `frame`.
TriangleMesh to_lattice(const TriangleMesh& mesh, const LatticeFrame& frame);

}  // namespace phyxel
