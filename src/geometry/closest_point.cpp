#include "geometry/closest_point.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace phyxel {
namespace {

double squared_distance_to_box(const Vec3& p, const Bounds& box) {
    double squared = 0;
    for (int c = 0; c < 3; ++c) {
        const double outside = std::max({box.lower[c] - p[c], p[c] - box.upper[c], 0.0});
        squared += outside * outside;
    }
    return squared;
}

}  // namespace

TrianglePoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const double area_squared = norm_squared(n);
    if (area_squared > 0) {
        // Above the triangle: barycentric coordinates of the foot point all positive.
        const double u = dot(cross(c - b, p - b), n), v = dot(cross(a - c, p - c), n), w = dot(cross(b - a, p - a), n);
        if (u >= 0 && v >= 0 && w >= 0)
            return {p - dot(p - a, n) / area_squared * n, {u / area_squared, v / area_squared, w / area_squared}};
    }
    TrianglePoint nearest{};
    double least = INFINITY;
    const std::array<Vec3, 3> corners{a, b, c};
    for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t f = (e + 1) % 3;
        const Vec3 edge = corners[f] - corners[e];
        const double length_squared = norm_squared(edge);
        const double t = length_squared > 0 ? std::clamp(dot(p - corners[e], edge) / length_squared, 0.0, 1.0) : 0.0;
        const Vec3 foot = t == 1 ? corners[f] : corners[e] + t * edge;
        const double squared = norm_squared(p - foot);
        if (squared >= least) continue;
        least = squared;
        nearest = {foot, {}};
        nearest.weights[e] = 1 - t;
        nearest.weights[f] = t;
    }
    return nearest;
}

SurfaceFoot closest_point(const TriangleMesh& mesh, const Bvh& tree, const Vec3& p, double reach) {
    SurfaceFoot nearest{no_triangle, {}, reach};
    if (tree.nodes.empty()) return nearest;
    double least = reach * reach;
    struct Visit {
        std::uint32_t node;
        double squared;
    };
    std::array<Visit, 128> stack;  // two a level of a balanced tree
    std::size_t open = 0;
    stack[open++] = {0, squared_distance_to_box(p, tree.nodes[0].box)};
    while (open > 0) {
        const Visit visit = stack[--open];
        if (visit.squared > least) continue;
        const Bvh::Node& node = tree.nodes[visit.node];
        if (!node.leaf()) {
            Visit near{visit.node + 1, squared_distance_to_box(p, tree.nodes[visit.node + 1].box)},
                far{node.right, squared_distance_to_box(p, tree.nodes[node.right].box)};
            if (far.squared < near.squared) std::swap(near, far);
            stack[open++] = far;
            stack[open++] = near;
            continue;
        }
        for (std::uint32_t k = node.begin; k < node.end; ++k) {
            const std::uint32_t triangle = tree.order[k];
            const Triangle& t = mesh.triangles[triangle];
            const TrianglePoint point = closest_point(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
            const double squared = norm_squared(p - point.position);
            if (squared < least || (squared == least && triangle < nearest.triangle)) {
                least = squared;
                nearest = {triangle, point, std::sqrt(squared)};
            }
        }
    }
    return nearest;
}

}  // namespace phyxel
