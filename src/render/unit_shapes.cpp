#include "render/unit_shapes.h"

#include <cmath>
#include <numbers>

namespace phyxel {
namespace {

/// Two triangles a, b, c and a, c, d.
void add_quad(ShapeMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

}  // namespace

ShapeMesh unit_sphere() {
    constexpr std::uint32_t rings = 32, sectors = 64;
    ShapeMesh mesh;
    for (std::uint32_t r = 0; r <= rings; ++r)
        for (std::uint32_t s = 0; s <= sectors; ++s) {
            const double polar = std::numbers::pi * r / rings, around = 2 * std::numbers::pi * s / sectors;
            mesh.positions.push_back(vector_cast<float>(
                Vec3{std::sin(polar) * std::sin(around), std::cos(polar), std::sin(polar) * std::cos(around)}));
        }
    mesh.normals = mesh.positions;
    for (std::uint32_t r = 0; r < rings; ++r)
        for (std::uint32_t s = 0; s < sectors; ++s) {
            const std::uint32_t a = r * (sectors + 1) + s, below = a + sectors + 1;
            add_quad(mesh, a, below, below + 1, a + 1);
        }
    return mesh;
}

ShapeMesh unit_cube() {
    ShapeMesh mesh;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const float side : {-0.5f, 0.5f}) {
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            Vec3f normal, u, v;
            normal[axis] = 2 * side, u[(axis + 1) % 3] = 0.5f, v[(axis + 2) % 3] = side;
            for (const Vec3f& corner : {-u - v, u - v, u + v, v - u}) {
                mesh.positions.push_back(0.5f * normal + corner);
                mesh.normals.push_back(normal);
            }
            add_quad(mesh, first, first + 1, first + 2, first + 3);
        }
    return mesh;
}

ShapeMesh unit_square() {
    ShapeMesh mesh{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, std::vector<Vec3f>(4, Vec3f{0, 0, 1}), {}};
    add_quad(mesh, 0, 1, 2, 3);
    return mesh;
}

}  // namespace phyxel
