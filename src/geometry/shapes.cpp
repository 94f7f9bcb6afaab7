#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "geometry/mesh_measure.h"
#include "phyxel/error.h"
#include "phyxel/mesh.h"

/// The built-in shapes. All are fine enough to bend with the body: the surface that is drawn has no other vertices.

namespace phyxel {

namespace {

constexpr int segments_of_longest_side = 16;  // of a box: a beam shows its bending, a cube has 3072 triangles
constexpr int sphere_subdivisions = 4;        // 5120 triangles
constexpr int segments_around = 48;           // of cylinder and torus

void require_positive(double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
        throw Error(std::string(what) + " is " + std::to_string(value) + ": give a positive, finite number of metres");
}

void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

/// Point i of n + 1 from -side/2 to side/2, both ends exact.
double along(double side, int i, int n) { return side * (2.0 * i - n) / (2.0 * n); }

}  // namespace

TriangleMesh make_box(const Vec3& sides) {
    for (std::size_t axis = 0; axis < 3; ++axis) require_positive(sides[axis], "a side of the box");
    const double longest = std::max({sides.x, sides.y, sides.z});
    std::array<int, 3> n;
    for (std::size_t axis = 0; axis < 3; ++axis)
        n[axis] = std::max(1, static_cast<int>(std::lround(segments_of_longest_side * sides[axis] / longest)));

    // Vertices are shared along edges by their place on the grid
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> vertex_of;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [entry, added] = vertex_of.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (added)
            mesh.vertices.push_back(
                {along(sides.x, at[0], n[0]), along(sides.y, at[1], n[1]), along(sides.z, at[2], n[2])});
        return entry->second;
    };

    // Two faces an axis; u, v, axis are right-handed, so that (u, v) order is outward on the upper face
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < n[u]; ++i)
            for (int j = 0; j < n[v]; ++j)
                for (const bool up : {false, true}) {
                    const auto corner = [&](int du, int dv) {
                        std::array<int, 3> at;
                        at[axis] = up ? n[axis] : 0;
                        at[u] = i + du;
                        at[v] = j + dv;
                        return vertex(at);
                    };
                    if (up) add_quad(mesh, corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
                    else add_quad(mesh, corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
                }
    }
    return mesh;
}

TriangleMesh make_sphere(double radius) {
    require_positive(radius, "the radius of the sphere");

    // Icosahedron: the even permutations of (0, +-1, +-golden ratio)
    const double g = std::numbers::phi;
    TriangleMesh mesh;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (Vec3& x : mesh.vertices) x = normalized(x);

    // Every triangle into four, new vertices onto the unit sphere
    for (int level = 0; level < sphere_subdivisions; ++level) {
        std::map<std::array<std::uint32_t, 2>, std::uint32_t> middle_of;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [entry, added] = middle_of.try_emplace({std::min(a, b), std::max(a, b)},
                                                              static_cast<std::uint32_t>(mesh.vertices.size()));
            if (added) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
            return entry->second;
        };
        std::vector<Triangle> finer;
        finer.reserve(4 * mesh.triangles.size());
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }

    // The polyhedron gets the sphere's volume: masses and stiffnesses are then those of the closed forms
    const double scale = radius * std::cbrt(4 * std::numbers::pi / 3 / signed_volume(mesh));
    for (Vec3& x : mesh.vertices) x *= scale;
    return mesh;
}

TriangleMesh make_cylinder(double radius, double height) {
    require_positive(radius, "the radius of the cylinder");
    require_positive(height, "the height of the cylinder");

    // The regular polygon gets the circle's area: n / 2 sin(2 pi / n) R^2 = pi r^2
    const int n = segments_around;
    const double step = 2 * std::numbers::pi / n;
    const double R = radius * std::sqrt(step / std::sin(step));

    // A profile (distance from the axis, height) goes around the axis; its ends are poles
    const int rings = n / 6;
    const int rows = std::clamp(static_cast<int>(std::lround(height / (R * step))), 1, 4 * n);
    std::vector<std::array<double, 2>> profile;
    for (int i = 1; i <= rings; ++i) profile.push_back({R * i / rings, -height / 2});
    for (int i = 1; i < rows; ++i) profile.push_back({R, along(height, i, rows)});
    for (int i = rings; i >= 1; --i) profile.push_back({R * i / rings, height / 2});

    TriangleMesh mesh;
    for (const auto& [distance, y] : profile)
        for (int k = 0; k < n; ++k)
            mesh.vertices.push_back({distance * std::cos(k * step), y, -distance * std::sin(k * step)});
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size()), top = bottom + 1;
    mesh.vertices.push_back({0, -height / 2, 0});
    mesh.vertices.push_back({0, height / 2, 0});

    const auto at = [&](std::size_t row, int k) { return static_cast<std::uint32_t>(row * n + k % n); };
    const std::size_t last = profile.size() - 1;
    for (int k = 0; k < n; ++k) {
        mesh.triangles.push_back({bottom, at(0, k + 1), at(0, k)});
        for (std::size_t row = 0; row < last; ++row)
            add_quad(mesh, at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row + 1, k));
        mesh.triangles.push_back({top, at(last, k), at(last, k + 1)});
    }
    return mesh;
}

TriangleMesh make_torus(double major_radius, double minor_radius) {
    require_positive(minor_radius, "the minor radius of the torus");
    if (!(major_radius > minor_radius) || !std::isfinite(major_radius))
        throw Error("the major radius of the torus is " + std::to_string(major_radius) +
                    ": give a finite number above its minor radius " + std::to_string(minor_radius) +
                    ", else the torus crosses itself");
    const int n = segments_around, m = segments_around / 2;
    TriangleMesh mesh;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < m; ++j) {
            const double u = 2 * std::numbers::pi * k / n, v = 2 * std::numbers::pi * j / m;
            const double distance = major_radius + minor_radius * std::cos(v);
            mesh.vertices.push_back({distance * std::cos(u), minor_radius * std::sin(v), -distance * std::sin(u)});
        }
    const auto at = [&](int k, int j) { return static_cast<std::uint32_t>((k % n) * m + j % m); };
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < m; ++j) add_quad(mesh, at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1));

    // The polyhedron gets the torus' volume, 2 pi^2 R r^2
    const double volume = 2 * std::numbers::pi * std::numbers::pi * major_radius * minor_radius * minor_radius;
    const double scale = std::cbrt(volume / signed_volume(mesh));
    for (Vec3& x : mesh.vertices) x *= scale;
    return mesh;
}

}  // namespace phyxel
