#include "geometry/line_of_sight.h"

#include <array>

namespace phyxel {
namespace {

/// Six times the signed volume of the tetrahedron (a, b, c, d).
double orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(b - a, cross(c - a, d - a));
}

/// The ends lie on opposite sides of the triangle's plane, and the line passes its three edges on the same side.
bool touches(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& t) {
    const double above = orientation(t[0], t[1], t[2], a), below = orientation(t[0], t[1], t[2], b);
    if ((above > 0 && below > 0) || (above < 0 && below < 0)) return false;
    const double u = orientation(a, b, t[0], t[1]), v = orientation(a, b, t[1], t[2]),
                 w = orientation(a, b, t[2], t[0]);
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

}  // namespace

bool LineOfSight::clear(const Vec3& a, const Vec3& b) const {
    Bounds segment;
    segment.add(a);
    segment.add(b);
    std::array<std::uint32_t, 64> stack;  // one entry a level of the tree
    std::size_t depth = 0;
    if (!bvh_.nodes.empty()) stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t index = stack[--depth];
        const Bvh::Node& node = bvh_.nodes[index];
        if (!node.box.overlaps(segment)) continue;
        if (!node.leaf()) {
            stack[depth++] = node.right;
            stack[depth++] = index + 1;
            continue;
        }
        for (std::uint32_t n = node.begin; n < node.end; ++n) {
            const Triangle& t = mesh_.triangles[bvh_.order[n]];
            if (touches(a, b, {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]})) return false;
        }
    }
    return true;
}

}  // namespace phyxel
