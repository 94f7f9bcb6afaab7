#include "geometry/thickness.h"

#include <algorithm>
#include <array>
#include <optional>

#include "geometry/bvh.h"

namespace phyxel {

namespace {

constexpr std::size_t most_samples = 5000;
constexpr double percentile = 0.01;
constexpr double smallest_cosine = 0.5;  // of the angle between the ray and the opposite side's normal

struct Hit {
    double distance = INFINITY;
    double cosine = 0;
};

/// Whether the ray passes the box before `farthest` (slabs; a direction along a side divides by zero, as it should).
bool reaches(const Bounds& box, const Vec3& origin, const Vec3& inverse_direction, double farthest) {
    double enter = 0, leave = farthest;
    for (std::size_t a = 0; a < 3; ++a) {
        const double t0 = (box.lower[a] - origin[a]) * inverse_direction[a];
        const double t1 = (box.upper[a] - origin[a]) * inverse_direction[a];
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return !(enter > leave);
}

/// Distance along the ray to the triangle; Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection"
/// (1997).
std::optional<double> distance_to(const std::array<Vec3, 3>& t, const Vec3& origin, const Vec3& direction) {
    const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = cross(direction, e2), s = origin - t[0], q = cross(s, e1);
    const double determinant = dot(e1, p);
    if (determinant == 0) return std::nullopt;
    const double u = dot(s, p) / determinant, v = dot(direction, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    return dot(e2, q) / determinant;
}

/// The nearest triangle through which the ray leaves the body, other than the one it starts from.
Hit first_exit(const TriangleMesh& mesh, const Bvh& bvh, std::size_t start, const Vec3& origin, const Vec3& direction) {
    const Vec3 inverse = {1 / direction.x, 1 / direction.y, 1 / direction.z};
    Hit nearest;
    std::vector<std::uint32_t> stack(1, 0);
    while (!stack.empty()) {
        const std::uint32_t index = stack.back();
        const Bvh::Node& node = bvh.nodes[index];
        stack.pop_back();
        if (!reaches(node.box, origin, inverse, nearest.distance)) continue;
        if (!node.leaf()) {
            stack.push_back(node.right);
            stack.push_back(index + 1);
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const Triangle& t = mesh.triangles[bvh.order[i]];
            const std::array<Vec3, 3> corners = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
            const double cosine = dot(direction, normalized(cross(corners[1] - corners[0], corners[2] - corners[0])));
            if (bvh.order[i] == start || cosine <= 0) continue;
            const auto distance = distance_to(corners, origin, direction);
            if (distance && *distance >= 0 && *distance < nearest.distance) nearest = {*distance, cosine};
        }
    }
    return nearest;
}

}  // namespace

Thickness local_thickness(const TriangleMesh& mesh) {
    struct Sample {
        double distance, area;
        Vec3 place;
    };
    std::vector<Sample> samples;
    double total = 0;
    const Bvh bvh = build_bvh(mesh);
    const std::size_t stride = (mesh.triangles.size() + most_samples - 1) / most_samples;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 area = 0.5 * cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
        if (norm_squared(area) == 0) continue;
        const Vec3 centroid = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0;
        const Hit hit = first_exit(mesh, bvh, t, centroid, -normalized(area));
        // Faces that lie on each other have nothing between them
        if (hit.cosine < smallest_cosine || hit.distance <= 1e-6 * std::sqrt(norm(area))) continue;
        samples.push_back({hit.distance, norm(area), centroid});
        total += norm(area);
    }
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.distance < b.distance; });
    double area = 0;
    for (const Sample& sample : samples) {
        area += sample.area;
        if (area >= percentile * total) return {sample.distance, sample.place};
    }
    return {INFINITY, {}};
}

}  // namespace phyxel
