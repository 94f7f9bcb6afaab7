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
            if (decided || level == finest_level) return add(8 * half.x * half.y * half.z, w);
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

    void add(double volume, double w) {
        if (w <= 0.5) return;
        result_.volume += volume;
        if (w < doubtful_below) result_.doubtful += volume;
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
