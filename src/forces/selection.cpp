#include "forces/selection.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "base/format.h"
#include "phyxel/error.h"

namespace phyxel {
namespace {

using Polygon = std::vector<Vec3>;

/// The part of a convex polygon with sign * (p[axis] - plane) <= 0.
Polygon clip_half_space(const Polygon& polygon, int axis, double plane, double sign) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double dp = sign * (p[axis] - plane), dq = sign * (q[axis] - plane);
        if (dp <= 0) kept.push_back(p);
        if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
    }
    return kept;
}

}  // namespace

SurfaceSelection select_surface(const Model& model, const TriangleMesh& mesh, const BoxSelection& box) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (const Vec3& X : mesh.vertices)
        for (int c = 0; c < 3; ++c) low[c] = std::min(low[c], X[c]), high[c] = std::max(high[c], X[c]);
    // A face that should lie on the box's own may miss it by rounding.
    const double slack = 1e-9 * norm(high - low);

    TriangleMesh inside;
    std::map<std::array<double, 3>, std::uint32_t> welded;
    for (const Triangle& t : mesh.triangles) {
        Polygon polygon = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
        for (int axis = 0; axis < 3 && polygon.size() >= 3; ++axis) {
            polygon = clip_half_space(polygon, axis, box.upper[axis] + slack, 1);
            polygon = clip_half_space(polygon, axis, box.lower[axis] - slack, -1);
        }
        if (polygon.size() < 3) continue;
        std::vector<std::uint32_t> corners;
        for (const Vec3& X : polygon) {
            const auto [vertex, is_new] =
                welded.insert({{X.x, X.y, X.z}, static_cast<std::uint32_t>(inside.vertices.size())});
            if (is_new) inside.vertices.push_back(model.sampling.frame.to_lattice(X));
            corners.push_back(vertex->second);
        }
        for (std::size_t k = 2; k < corners.size(); ++k)
            inside.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }

    SurfaceSelection selection;
    for (const SurfacePoint& piece : cut_surface(inside, model.sampling.pitch / 2)) {
        if (norm(piece.area) == 0) continue;
        selection.position.push_back(piece.position);
        selection.area.push_back(piece.area);
        selection.cell.push_back(model.sampling.locate(piece.position, piece.area));
        selection.total_area += norm(piece.area);
    }
    const double extent = norm(high - low);
    if (selection.total_area <= 1e-12 * extent * extent)
        throw Error("the box from " + format_point(box.lower) + " to " + format_point(box.upper) +
                    " selects nothing of the surface, which reaches from " + format_point(low) + " to " +
                    format_point(high) + " m in rest space. Move or enlarge the box");
    return selection;
}

}  // namespace phyxel
