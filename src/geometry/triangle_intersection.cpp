#include "geometry/triangle_intersection.h"

#include <algorithm>
#include <array>

namespace phyxel {

namespace {

/// A triangle with its unit normal; that of a triangle without area is zero.
struct Plane {
    std::array<Vec3, 3> corners;
    Vec3 normal;

    explicit Plane(const std::array<Vec3, 3>& c) : corners(c), normal(normalized(cross(c[1] - c[0], c[2] - c[0]))) {}

    double height(const Vec3& x) const { return dot(normal, x - corners[0]); }
    /// Whether a point of the plane is inside the triangle or on its rim.
    bool holds(const Vec3& x) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (dot(normal, cross(corners[(k + 1) % 3] - corners[k], x - corners[k])) < 0) return false;
        return true;
    }
};

std::array<double, 3> heights(const Plane& above, const Plane& triangle) {
    return {above.height(triangle.corners[0]), above.height(triangle.corners[1]), above.height(triangle.corners[2])};
}

bool all_on_one_side(const std::array<double, 3>& h, double tolerance) {
    return (h[0] <= tolerance && h[1] <= tolerance && h[2] <= tolerance) ||
           (h[0] >= -tolerance && h[1] >= -tolerance && h[2] >= -tolerance);
}

bool all_in_plane(const std::array<double, 3>& h, double tolerance) {
    return std::max({std::abs(h[0]), std::abs(h[1]), std::abs(h[2])}) <= tolerance;
}

/// Where an edge of `a`, whose corners are at `h` above `b`, passes through `b`.
std::optional<Vec3> edge_through(const Plane& a, const std::array<double, 3>& h, const Plane& b, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        const double from = h[k], to = h[(k + 1) % 3];
        if (std::min(from, to) >= -tolerance || std::max(from, to) <= tolerance) continue;
        const Vec3 x = a.corners[k] + from / (from - to) * (a.corners[(k + 1) % 3] - a.corners[k]);
        if (b.holds(x)) return x;
    }
    return std::nullopt;
}

/// Whether the lines along `a`'s edges fail to separate `b` from it, by more than the tolerance; both in one plane.
bool edges_fail_to_separate(const Plane& a, const Plane& b, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 inward = normalized(cross(a.normal, a.corners[(k + 1) % 3] - a.corners[k]));
        double deepest = -INFINITY;
        for (const Vec3& x : b.corners) deepest = std::max(deepest, dot(inward, x - a.corners[k]));
        if (deepest <= tolerance) return false;
    }
    return true;
}

std::optional<Vec3> intersect(const Plane& a, const Plane& b, double tolerance) {
    const Vec3 none{};
    if (a.normal == none || b.normal == none) return std::nullopt;
    const std::array<double, 3> a_over_b = heights(b, a), b_over_a = heights(a, b);
    if (all_in_plane(a_over_b, tolerance) && all_in_plane(b_over_a, tolerance)) {
        if (dot(a.normal, b.normal) < 0 || !edges_fail_to_separate(a, b, tolerance) ||
            !edges_fail_to_separate(b, a, tolerance))
            return std::nullopt;
        const Plane& smaller =
            norm_squared(a.corners[1] - a.corners[0]) < norm_squared(b.corners[1] - b.corners[0]) ? a : b;
        return (smaller.corners[0] + smaller.corners[1] + smaller.corners[2]) / 3.0;
    }
    if (all_on_one_side(a_over_b, tolerance) || all_on_one_side(b_over_a, tolerance)) return std::nullopt;
    if (const auto x = edge_through(a, a_over_b, b, tolerance)) return x;
    return edge_through(b, b_over_a, a, tolerance);
}

int common_vertices(const Triangle& s, const Triangle& t) {
    int common = 0;
    for (const std::uint32_t v : s) common += v == t[0] || v == t[1] || v == t[2];
    return common;
}

}  // namespace

std::optional<Vec3> intersect_triangles(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double tolerance) {
    return intersect(Plane(a), Plane(b), tolerance);
}

SelfIntersections find_self_intersections(const TriangleMesh& mesh, const Bvh& bvh) {
    SelfIntersections found;
    if (bvh.nodes.empty()) return found;
    const Vec3 size = bvh.nodes[0].box.size();
    const double tolerance = contact_tolerance * std::max({size.x, size.y, size.z});

    // Data of each triangle once, in the tree's order
    std::vector<Plane> planes;
    std::vector<Bounds> boxes;
    for (const std::uint32_t t : bvh.order) {
        const auto& [a, b, c] = mesh.triangles[t];
        planes.emplace_back(std::array{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
        boxes.push_back(triangle_box(mesh, t));
    }

    // Each against those after it in the tree's order
    std::vector<Vec3> places;
    std::vector<std::uint32_t> stack;
    for (std::uint32_t i = 0; i < planes.size() && found.complete; ++i) {
        stack.assign(1, 0);
        while (!stack.empty()) {
            const std::uint32_t index = stack.back();
            const Bvh::Node& node = bvh.nodes[index];
            stack.pop_back();
            if (node.end <= i + 1 || !node.box.overlaps(boxes[i])) continue;
            if (!node.leaf()) {
                stack.push_back(node.right);
                stack.push_back(index + 1);
                continue;
            }
            for (std::uint32_t j = std::max(node.begin, i + 1); j < node.end; ++j) {
                if (!boxes[i].overlaps(boxes[j])) continue;
                if (common_vertices(mesh.triangles[bvh.order[i]], mesh.triangles[bvh.order[j]]) >= 2) continue;
                if (const auto place = intersect(planes[i], planes[j], tolerance)) places.push_back(*place);
            }
        }
        found.complete = places.size() < most_intersecting_pairs;
    }

    found.pairs = places.size();
    const std::size_t shown = std::min<std::size_t>(16, places.size());
    for (std::size_t k = 0; k < shown; ++k) found.places.push_back(places[k * places.size() / shown]);
    return found;
}

}  // namespace phyxel
