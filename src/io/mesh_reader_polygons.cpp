#include <algorithm>
#include <array>
#include <numeric>

#include "io/mesh_reader_formats.h"

/// Polygons into triangles.

namespace phyxel {

namespace {

/// Clipping tests every ear against every other corner: longer polygons that are not convex are refused.
constexpr std::size_t longest_concave_polygon = 4096;

struct Point2 {
    double u, v;
};

double twice_area(const Point2& a, const Point2& b, const Point2& c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

/// Twice the area vector of a polygon (Newell's sum).
Vec3 polygon_normal(const std::vector<Vec3>& corners) {
    Vec3 normal;
    for (std::size_t i = 2; i < corners.size(); ++i)
        normal += cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
    return normal;
}

/// The corners seen along the normal's longest axis, so that the polygon is counter-clockwise.
std::vector<Point2> flatten(const std::vector<Vec3>& corners) {
    const Vec3 normal = polygon_normal(corners);
    const Vec3 size = {std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    std::vector<Point2> points;
    for (const Vec3& x : corners) points.push_back({x[u], x[v]});
    return points;
}

/// Turns left at every corner, and once around in all (a star also turns left everywhere).
bool is_convex(const std::vector<Point2>& p) {
    int sign_changes = 0;
    for (std::size_t i = 0, n = p.size(); i < n; ++i) {
        const Point2 &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
        if (!(twice_area(a, b, c) >= 0)) return false;
        sign_changes += (b.u - a.u < 0) != (c.u - b.u < 0);
    }
    return sign_changes <= 2;
}

bool covers(const Point2& a, const Point2& b, const Point2& c, const Point2& p) {
    const auto same = [&](const Point2& q) { return q.u == p.u && q.v == p.v; };
    if (same(a) || same(b) || same(c)) return false;
    return twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
}

/// Whether corner i of the ring can be cut off: it turns left and its triangle holds no other corner.
bool is_ear(const std::vector<Point2>& points, const std::vector<std::uint32_t>& ring, std::size_t i) {
    const std::size_t n = ring.size();
    const Point2 &a = points[ring[(i + n - 1) % n]], &b = points[ring[i]], &c = points[ring[(i + 1) % n]];
    if (!(twice_area(a, b, c) > 0)) return false;
    return std::none_of(ring.begin(), ring.end(), [&](std::uint32_t k) { return covers(a, b, c, points[k]); });
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(const std::vector<Vec3>& corners) {
    const auto n = static_cast<std::uint32_t>(corners.size());
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const std::vector<Point2> points = flatten(corners);
    if (is_convex(points)) {
        for (std::uint32_t i = 2; i < n; ++i) triangles.push_back({0, i - 1, i});
        return triangles;
    }
    std::vector<std::uint32_t> ring(n);
    std::iota(ring.begin(), ring.end(), 0u);
    std::size_t at = 0;
    while (ring.size() >= 3) {
        // The next ear from here on; a polygon that has none crosses itself, and loses any corner
        const std::size_t size = ring.size();
        std::size_t tried = 0;
        while (tried < size && !is_ear(points, ring, (at + tried) % size)) ++tried;
        const std::size_t ear = (at + tried) % size;
        triangles.push_back({ring[(ear + size - 1) % size], ring[ear], ring[(ear + 1) % size]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
        at = ear;
    }
    return triangles;
}

void PolygonMesh::end_polygon(std::size_t place) {
    ends.push_back(corners.size());
    places.push_back(place);
}

void PolygonMesh::end_part(const std::string& part_name, std::size_t begin) {
    if (polygons() > begin) parts.push_back({part_name, begin, polygons()});
}

TriangleMesh triangulate(const PolygonMesh& polygons, const MeshFile& file) {
    TriangleMesh mesh;
    mesh.vertices = polygons.vertices;
    if (mesh.vertices.size() >= UINT32_MAX) file.fail("", "more than 4 billion vertices: split the mesh");
    const auto count = static_cast<std::int64_t>(mesh.vertices.size());
    std::vector<std::size_t> first_triangle;  // [polygons + 1]
    std::vector<Vec3> corners;
    for (std::size_t p = 0, begin = 0; p < polygons.polygons(); begin = polygons.ends[p++]) {
        first_triangle.push_back(mesh.triangles.size());
        const std::string place = polygons.place_unit + " ";
        const auto fail = [&](const std::string& message) {
            file.fail(place + std::to_string(polygons.places[p]), message);
        };

        // Check the corners
        const std::size_t size = polygons.ends[p] - begin;
        const std::int64_t* corner = polygons.corners.data() + begin;
        if (size < 3) fail("a face of " + std::to_string(size) + " corners, where at least 3 are needed: remove it");
        for (std::size_t k = 0; k < size; ++k) {
            if (corner[k] < 0 || corner[k] >= count)
                fail("a face uses vertex " + std::to_string(corner[k] + polygons.first_index) + ", but the file has " +
                     std::to_string(count) + " vertices, counted from " + std::to_string(polygons.first_index) +
                     ": the file is truncated or damaged, export it again");
        }

        // Cut
        const auto index = [&](std::size_t k) { return static_cast<std::uint32_t>(corner[k]); };
        if (size == 3) {
            mesh.triangles.push_back({index(0), index(1), index(2)});
        } else {
            if (size > longest_concave_polygon)
                fail("a face of " + std::to_string(size) + " corners, more than the " +
                     std::to_string(longest_concave_polygon) + " that can be cut: export the mesh as triangles");
            corners.clear();
            for (std::size_t k = 0; k < size; ++k) corners.push_back(mesh.vertices[index(k)]);
            for (const auto& [a, b, c] : triangulate_polygon(corners))
                mesh.triangles.push_back({index(a), index(b), index(c)});
        }
    }
    first_triangle.push_back(mesh.triangles.size());
    for (const TriangleMesh::Part& part : polygons.parts)
        mesh.parts.push_back({part.name, first_triangle[part.begin], first_triangle[part.end]});
    std::stable_sort(mesh.parts.begin(), mesh.parts.end(),
                     [](const auto& a, const auto& b) { return a.begin < b.begin; });
    return mesh;
}

}  // namespace phyxel
