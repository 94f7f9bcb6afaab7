#include "geometry/surface_cut.h"

#include "geometry/merged_pieces.h"

namespace phyxel {

TriangleMesh snapped_to_planes(const TriangleMesh& mesh, double pitch) {
    // Coordinates of a mesh that was moved a thousand of its sizes away still carry this many digits.
    constexpr double rounding = 1e-11;
    TriangleMesh snapped{mesh.vertices, mesh.triangles, {}, {}};
    for (Vec3& X : snapped.vertices)
        for (std::size_t c = 0; c < 3; ++c) {
            const double plane = std::round(X[c] / pitch) * pitch;
            if (std::abs(X[c] - plane) <= rounding * pitch) X[c] = plane;
        }
    return snapped;
}

SurfacePoint surface_point(const ConvexPolygon& piece, std::uint32_t triangle) {
    // Fan of triangles from the first corner.
    const Vec3& apex = piece.points[0];
    Vec3 area, mean;
    for (std::size_t p = 1; p < piece.size; ++p) {
        const Vec3 edge = piece.points[p] - apex;
        mean += edge;
        if (p + 1 < piece.size) area += 0.5 * cross(edge, piece.points[p + 1] - apex);
    }
    const Vec3 normal = normalized(area);
    Vec3 moment;
    double weight = 0, magnitude = 0;
    for (std::size_t p = 1; p + 1 < piece.size; ++p) {
        const Vec3 e = piece.points[p] - apex, f = piece.points[p + 1] - apex;
        const double w = 0.5 * dot(cross(e, f), normal);
        weight += w;
        magnitude += std::abs(w);
        moment += (e + f) * (w / 3);
    }
    // A piece thinner than rounding has no usable fan.
    const bool sound = weight > 0.5 * magnitude;
    const Vec3 centroid = sound ? moment / weight : mean / static_cast<double>(piece.size);
    return {apex + centroid, area, triangle};
}

StripTriangles::StripTriangles(const TriangleMesh& mesh, double pitch) {
    // Range of every triangle.
    std::vector<LatticeRange> ranges(mesh.triangles.size());
    ConvexPolygon polygon;
    int last = 0;
    for (std::size_t t = 0; t < ranges.size(); ++t) {
        set_triangle(polygon, mesh, t);
        ranges[t] = lattice_range<0>(polygon, pitch);
        first = t == 0 ? ranges[t].first : std::min(first, ranges[t].first);
        last = t == 0 ? ranges[t].last : std::max(last, ranges[t].last);
    }

    // Count, then fill.
    offset.assign(ranges.empty() ? 1 : static_cast<std::size_t>(last - first) + 2, 0);
    for (const LatticeRange& r : ranges)
        for (int i = r.first; i <= r.last; ++i) ++offset[static_cast<std::size_t>(i - first) + 1];
    for (std::size_t s = 1; s < offset.size(); ++s) offset[s] += offset[s - 1];
    triangles.resize(offset.back());
    std::vector<std::size_t> next(offset.begin(), offset.end() - 1);
    for (std::size_t t = 0; t < ranges.size(); ++t)
        for (int i = ranges[t].first; i <= ranges[t].last; ++i)
            triangles[next[static_cast<std::size_t>(i - first)]++] = static_cast<std::uint32_t>(t);
}

std::vector<SurfacePoint> cut_surface(const TriangleMesh& original, double pitch) {
    const TriangleMesh mesh = snapped_to_planes(original, pitch);
    std::vector<SurfacePoint> points;
    points.reserve(2 * mesh.triangles.size());
    ConvexPolygon triangle;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        set_triangle(triangle, mesh, t);
        visit_pieces(triangle, pitch, [&](int, int, int, const ConvexPolygon& piece) {
            const SurfacePoint point = surface_point(piece, static_cast<std::uint32_t>(t));
            if (norm_squared(point.area) > 0) points.push_back(point);
        });
    }
    return merge_coplanar(points, mesh, pitch);
}

}  // namespace phyxel
