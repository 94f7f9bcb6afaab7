#include "geometry/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

double distance_to_box(const Vec3& p, const Bounds& box) {
    double squared = 0;
    for (int c = 0; c < 3; ++c) {
        const double outside = std::max({box.lower[c] - p[c], p[c] - box.upper[c], 0.0});
        squared += outside * outside;
    }
    return std::sqrt(squared);
}

}  // namespace

double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const double area_squared = norm_squared(n);
    if (area_squared > 0) {
        // Above the triangle: barycentric coordinates of the foot point all positive.
        const double u = dot(cross(c - b, p - b), n), v = dot(cross(a - c, p - c), n), w = dot(cross(b - a, p - a), n);
        if (u >= 0 && v >= 0 && w >= 0) return std::abs(dot(p - a, n)) / std::sqrt(area_squared);
    }
    const auto to_edge = [&](const Vec3& q, const Vec3& r) {
        const double length_squared = norm_squared(r - q);
        const double t = length_squared > 0 ? std::clamp(dot(p - q, r - q) / length_squared, 0.0, 1.0) : 0.0;
        return norm(p - (q + t * (r - q)));
    };
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

double SurfaceDistance::operator()(const Vec3& p, double reach) const {
    double nearest = reach;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty() && !tree_.nodes.empty()) {
        const std::uint32_t at = stack.back();
        const Bvh::Node& node = tree_.nodes[at];
        stack.pop_back();
        if (distance_to_box(p, node.box) >= nearest) continue;
        if (!node.leaf()) {
            stack.push_back(node.right);
            stack.push_back(at + 1);
            continue;
        }
        for (std::uint32_t k = node.begin; k < node.end; ++k) {
            const Triangle& t = mesh_.triangles[tree_.order[k]];
            nearest = std::min(
                nearest, distance_to_triangle(p, mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]));
        }
    }
    return winding_.inside(p) ? -nearest : nearest;
}

}  // namespace phyxel
