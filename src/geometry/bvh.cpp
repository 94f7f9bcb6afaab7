#include "geometry/bvh.h"

#include <algorithm>
#include <numeric>

namespace phyxel {

void Bounds::add(const Vec3& p) {
    for (std::size_t a = 0; a < 3; ++a) {
        lower[a] = std::min(lower[a], p[a]);
        upper[a] = std::max(upper[a], p[a]);
    }
}

void Bounds::add(const Bounds& box) {
    add(box.lower);
    add(box.upper);
}

bool Bounds::overlaps(const Bounds& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y &&
           lower.z <= b.upper.z && b.lower.z <= upper.z;
}

Bounds triangle_box(const TriangleMesh& mesh, std::size_t triangle) {
    Bounds box;
    for (const std::uint32_t v : mesh.triangles[triangle]) box.add(mesh.vertices[v]);
    return box;
}

Bounds bounding_box(const TriangleMesh& mesh) {
    Bounds box;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) box.add(triangle_box(mesh, t));
    return box;
}

namespace {

class Builder {
public:
    Builder(const TriangleMesh& mesh, std::size_t leaf_size) : leaf_size_(leaf_size) {
        boxes_.reserve(mesh.triangles.size());
        centers_.reserve(mesh.triangles.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            boxes_.push_back(triangle_box(mesh, t));
            centers_.push_back(boxes_.back().center());
        }
        bvh_.order.resize(mesh.triangles.size());
        std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
        if (!bvh_.order.empty()) build(0, static_cast<std::uint32_t>(bvh_.order.size()));
    }

    Bvh take() { return std::move(bvh_); }

private:
    void build(std::uint32_t begin, std::uint32_t end) {
        const std::size_t self = bvh_.nodes.size();
        bvh_.nodes.push_back({.box = {}, .begin = begin, .end = end, .right = 0});
        Bounds centers;
        for (std::uint32_t i = begin; i < end; ++i) {
            bvh_.nodes[self].box.add(boxes_[bvh_.order[i]]);
            centers.add(centers_[bvh_.order[i]]);
        }
        if (end - begin <= leaf_size_) return;

        // Split at the median; equal centres go by id, so that the tree does not depend on the library's sort.
        const Vec3 size = centers.size();
        const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t middle = begin + (end - begin) / 2;
        const auto first = bvh_.order.begin();
        std::nth_element(first + begin, first + middle, first + end, [&](std::uint32_t a, std::uint32_t b) {
            const double ca = centers_[a][axis], cb = centers_[b][axis];
            return ca != cb ? ca < cb : a < b;
        });
        build(begin, middle);
        bvh_.nodes[self].right = static_cast<std::uint32_t>(bvh_.nodes.size());
        build(middle, end);
    }

    std::size_t leaf_size_;
    std::vector<Bounds> boxes_;
    std::vector<Vec3> centers_;
    Bvh bvh_;
};

}  // namespace

Bvh build_bvh(const TriangleMesh& mesh, std::size_t leaf_size) { return Builder(mesh, leaf_size).take(); }

}  // namespace phyxel
