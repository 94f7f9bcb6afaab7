#include "contact/moving_surface.h"

#include <algorithm>
#include <cmath>

namespace phyxel {

MovingSurface::MovingSurface(std::vector<Triangle> triangles, std::size_t vertices) : triangles_(std::move(triangles)) {
    offset_.assign(vertices + 1, 0);
    for (const Triangle& t : triangles_)
        for (std::uint32_t v : t) ++offset_[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) offset_[v + 1] += offset_[v];
    fan_.resize(offset_.back());
    std::vector<std::uint32_t> next(offset_.begin(), offset_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        for (std::uint32_t v : triangles_[t]) fan_[next[v]++] = t;
}

Vec3 MovingSurface::outward(const std::vector<Vec3>& vertices, const SurfaceFoot& foot) const {
    const Triangle& own = triangles_[foot.triangle];
    const auto normal = [&](const Triangle& t) {
        return normalized(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]));
    };
    std::uint32_t touched[3];
    std::size_t corners = 0;
    for (std::size_t c = 0; c < 3; ++c)
        if (foot.point.weights[c] > 0) touched[corners++] = own[c];
    if (corners == 3) return normal(own);

    Vec3 sum{};
    for (std::uint32_t k = offset_[touched[0]]; k < offset_[touched[0] + 1]; ++k) {
        const Triangle& t = triangles_[fan_[k]];
        if (corners == 2) {
            if (std::find(t.begin(), t.end(), touched[1]) != t.end()) sum += normal(t);
            continue;
        }
        const std::size_t c = static_cast<std::size_t>(std::find(t.begin(), t.end(), touched[0]) - t.begin());
        const Vec3 a = vertices[t[(c + 1) % 3]] - vertices[t[c]], b = vertices[t[(c + 2) % 3]] - vertices[t[c]];
        sum += std::atan2(norm(cross(a, b)), dot(a, b)) * normal(t);
    }
    return normalized(sum);
}

}  // namespace phyxel
