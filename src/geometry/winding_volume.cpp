#include "geometry/winding_volume.h"

#include <algorithm>

namespace phyxel {

namespace {

constexpr int coarsest_level = 3, finest_level = 5;  // 8 and 32 cells along each side
constexpr double clear_margin = 0.25;                // from 1/2, where a cell without surface counts as a whole
constexpr double doubtful_below = 0.7;

class Octree {
public:
    Octree(const TriangleMesh& mesh, const WindingNumber& winding_number)
        : mesh_(mesh), winding_number_(winding_number) {}

    WindingVolume measure() {
        std::vector<std::uint32_t> all(mesh_.triangles.size());
        for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
        const Bounds box = bounding_box(mesh_);
        visit(box.center(), 0.5 * box.size(), 0, all);
        return result_;
    }

private:
    void visit(const Vec3& center, const Vec3& half, int level, const std::vector<std::uint32_t>& candidates) {
        if (level >= coarsest_level) {
            const double w = winding_number_(center);
            const bool decided = candidates.empty() && std::abs(w - 0.5) > clear_margin;
            if (decided || level == finest_level)
                return add(8 * half.x * half.y * half.z * inside_share(center, half, w, candidates), w);
        }
        const Vec3 quarter = 0.5 * half;
        std::vector<std::uint32_t> passing;
        for (unsigned child = 0; child < 8; ++child) {
            const Vec3 c = center + Vec3{child & 1 ? quarter.x : -quarter.x, child & 2 ? quarter.y : -quarter.y,
                                         child & 4 ? quarter.z : -quarter.z};
            passing.clear();
            for (const std::uint32_t t : candidates)
                if (passes(t, c, quarter)) passing.push_back(t);
            visit(c, quarter, level + 1, passing);
        }
    }

    /// Whether triangle `t` may pass the cell: their boxes overlap, and its plane cuts the cell.
    bool passes(std::uint32_t t, const Vec3& center, const Vec3& half) const {
        if (!triangle_box(mesh_, t).overlaps({center - half, center + half})) return false;
        const auto& [a, b, c] = mesh_.triangles[t];
        const Vec3& corner = mesh_.vertices[a];
        const Vec3 normal = cross(mesh_.vertices[b] - corner, mesh_.vertices[c] - corner);
        const double reach = std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
        return std::abs(dot(normal, center - corner)) <= reach * (1 + 1e-12);
    }

    /// The share of a cell that lies inside. Where a surface passes that parts inside from outside, the nearest plane
    /// cuts the cell, and the share is taken to be linear in the centre's height above it.
    double inside_share(const Vec3& center, const Vec3& half, double w,
                        const std::vector<std::uint32_t>& passing) const {
        const double whole = w > 0.5 ? 1 : 0;
        double height = 0, nearest = INFINITY, reach = 0;
        Vec3 plane;
        for (const std::uint32_t t : passing) {
            const auto& [a, b, c] = mesh_.triangles[t];
            const Vec3& corner = mesh_.vertices[a];
            const Vec3 normal = normalized(cross(mesh_.vertices[b] - corner, mesh_.vertices[c] - corner));
            const double h = dot(normal, center - corner);
            if (normal == Vec3{} || std::abs(h) >= nearest) continue;
            nearest = std::abs(h);
            height = h;
            plane = normal;
            reach = std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
        }
        if (nearest >= reach) return whole;
        const double step = height >= 0 ? std::max(2 * height, 1e-3 * reach) : std::min(2 * height, -1e-3 * reach);
        const double beyond = winding_number_(center - step * plane);
        if ((beyond > 0.5) == (w > 0.5)) return whole;
        return 0.5 - 0.5 * height / reach;
    }

    void add(double volume, double w) {
        result_.volume += volume;
        if (w > 0.5 && w < doubtful_below) result_.doubtful += volume;
    }

    const TriangleMesh& mesh_;
    const WindingNumber& winding_number_;
    WindingVolume result_;
};

}  // namespace

WindingVolume winding_volume(const TriangleMesh& mesh, const WindingNumber& winding_number) {
    return mesh.triangles.empty() ? WindingVolume{} : Octree(mesh, winding_number).measure();
}

}  // namespace phyxel
