#include "sampling/lattice_frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/bvh.h"

namespace phyxel {
namespace {

/// First plane of a lattice of pitch `a` over the side [low, high]. Faces of a turned box wobble by rounding, which
/// would leave slivers behind the planes: a side that the pitch divides to 1e-4 counts as divided.
double first_plane(double low, double high, double a) {
    const double cells = std::max(1.0, std::round((high - low) / a));
    return std::abs((high - low) / a - cells) <= 1e-4 ? low : 0.5 * (low + high) - 0.5 * cells * a;
}

}  // namespace

Mat3 rotation_matrix(const AxisAngle& rotation) {
    if (rotation.degrees == 0) return Mat3::identity();
    return rotation_about(normalized(rotation.axis), rotation.degrees * std::numbers::pi / 180);
}

LatticeFrame place_lattice(const TriangleMesh& mesh, const Mat3& body_rotation, const AxisAngle& lattice_rotation,
                           double pitch) {
    LatticeFrame frame{body_rotation * rotation_matrix(lattice_rotation), {}};
    Bounds box;
    for (const Vec3& X : mesh.vertices) box.add(frame.to_lattice(X));
    Vec3 first;
    for (int c = 0; c < 3; ++c) first[c] = first_plane(box.lower[c], box.upper[c], pitch);
    frame.origin = frame.rotation * first;
    return frame;
}

TriangleMesh to_lattice(const TriangleMesh& mesh, const LatticeFrame& frame) {
    TriangleMesh moved = mesh;
    for (Vec3& X : moved.vertices) X = frame.to_lattice(X);
    return moved;
}

}  // namespace phyxel
