#include "reference/fem/mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace phyxel::fem {
namespace {

using Index3 = std::array<std::size_t, 3>;

Index3 grid_nodes(const Mesh& mesh) {
    const std::size_t step = nodes_per_edge(mesh.type) - 1;
    return {step * mesh.cells[0] + 1, step * mesh.cells[1] + 1, step * mesh.cells[2] + 1};
}

std::size_t node_number(const Index3& nodes, const Index3& at) { return at[0] + nodes[0] * (at[1] + nodes[1] * at[2]); }

void add_nodes(Mesh& mesh) {
    const Index3 n = grid_nodes(mesh);
    for (std::size_t k = 0; k < n[2]; ++k)
        for (std::size_t j = 0; j < n[1]; ++j)
            for (std::size_t i = 0; i < n[0]; ++i)
                mesh.X.push_back({mesh.size.x * double(i) / double(n[0] - 1),
                                  mesh.size.y * double(j) / double(n[1] - 1),
                                  mesh.size.z * double(k) / double(n[2] - 1)});
}

void add_hexahedron(Mesh& mesh, const Index3& cell) {
    const Index3 n = grid_nodes(mesh);
    const std::size_t edge = nodes_per_edge(mesh.type), step = edge - 1;
    for (std::size_t c = 0; c < edge; ++c)
        for (std::size_t b = 0; b < edge; ++b)
            for (std::size_t a = 0; a < edge; ++a)
                mesh.elements.push_back(node_number(n, {step * cell[0] + a, step * cell[1] + b, step * cell[2] + c}));
}

/// Corners of a box by bits: 1 along x, 2 along y, 4 along z.
using Corners = std::array<std::size_t, 4>;

/// Each path from corner 0 to corner 7 along three edges is one tetrahedron (Kuhn's subdivision).
constexpr std::array<Corners, 6> six_tetrahedra = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};
constexpr std::array<Corners, 5> five_tetrahedra = {
    {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 4, 2, 7}, {1, 2, 4, 7}}};

/// Bits of the axes in which the pattern of a box is mirrored. Boxes must cut the face that they share alike: the
/// diagonal of a face across x turns when the pattern is mirrored in y or in z, and not when it is mirrored in x.
std::size_t mirrored_axes(Split split, const Index3& cell) {
    switch (split) {
        case Split::six:
            return 0;
        case Split::six_mirrored:
            return 1;
        case Split::six_alternating:
            return (cell[0] % 2 ? 1 : 0) | (cell[1] % 2 ? 2 : 0) | (cell[2] % 2 ? 4 : 0);
        case Split::five:
            break;
    }
    return (cell[0] + cell[1] + cell[2]) % 2;
}

void add_tetrahedra(Mesh& mesh, const Index3& cell) {
    const Index3 n = grid_nodes(mesh);
    const std::size_t mirror = mirrored_axes(mesh.split, cell);
    const auto add = [&](const Corners& corners) {
        for (std::size_t corner : corners) {
            corner ^= mirror;
            mesh.elements.push_back(
                node_number(n, {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)}));
        }
    };
    if (mesh.split == Split::five)
        for (const Corners& corners : five_tetrahedra) add(corners);
    else
        for (const Corners& corners : six_tetrahedra) add(corners);
}

std::size_t axis_of(Face face) { return static_cast<std::size_t>(face) / 2; }
bool is_upper(Face face) { return static_cast<std::size_t>(face) % 2 == 1; }

/// Share of the local nodes of an edge in its length: trapezoid or Simpson's rule.
double edge_share(std::size_t nodes, std::size_t local) {
    if (nodes == 2) return 1.0 / 2;
    return local == 1 ? 4.0 / 6 : 1.0 / 6;
}

/// Share of a hexahedron's local node in the area of the element's faces across `axis`.
double face_share(ElementType type, std::size_t local, std::size_t axis) {
    const std::size_t n = nodes_per_edge(type);
    const Index3 at = {local % n, local / n % n, local / (n * n)};
    return edge_share(n, at[(axis + 1) % 3]) * edge_share(n, at[(axis + 2) % 3]);
}

/// Reference coordinates of a rest point in an element, by the inverse of the element's map. That map is affine in a
/// box mesh, so that the slopes at any point give it.
Vec3 reference_coordinates(const Mesh& mesh, const std::size_t* nodes, const Vec3& point) {
    const Vec3 xi{};
    const Shape shape = shape_at(mesh.type, xi);
    Vec3 origin;
    Mat3 map;
    for (std::size_t a = 0; a < shape.phi.size(); ++a) {
        origin += shape.phi[a] * mesh.X[nodes[a]];
        map += outer(mesh.X[nodes[a]], shape.slope[a]);
    }
    return inverse(map) * (point - origin);
}

/// How far outside of the element, in reference coordinates; negative inside.
double outside(ElementType type, const Vec3& xi) {
    if (type == ElementType::tetrahedra) return std::max({-xi.x, -xi.y, -xi.z, xi.x + xi.y + xi.z - 1});
    return std::max({std::abs(xi.x), std::abs(xi.y), std::abs(xi.z)}) - 1;
}

}  // namespace

Mesh box_mesh(ElementType type, const std::array<std::size_t, 3>& cells, const Vec3& size, Split split) {
    assert(cells[0] > 0 && cells[1] > 0 && cells[2] > 0);
    Mesh mesh{.type = type, .split = split, .cells = cells, .size = size, .X = {}, .elements = {}};
    add_nodes(mesh);
    for (std::size_t k = 0; k < cells[2]; ++k)
        for (std::size_t j = 0; j < cells[1]; ++j)
            for (std::size_t i = 0; i < cells[0]; ++i)
                if (type == ElementType::tetrahedra) add_tetrahedra(mesh, {i, j, k});
                else add_hexahedron(mesh, {i, j, k});
    return mesh;
}

std::size_t element_count(const Mesh& mesh) { return mesh.elements.size() / nodes_per_element(mesh.type); }

std::vector<bool> nodes_on(const Mesh& mesh, Face face) {
    const Index3 n = grid_nodes(mesh);
    const std::size_t axis = axis_of(face), wanted = is_upper(face) ? n[axis] - 1 : 0;
    std::vector<bool> on(mesh.X.size());
    for (std::size_t i = 0; i < on.size(); ++i) {
        const Index3 at = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
        on[i] = at[axis] == wanted;
    }
    return on;
}

std::vector<double> face_weights(const Mesh& mesh, Face face) {
    const std::vector<bool> on = nodes_on(mesh, face);
    const std::size_t count = nodes_per_element(mesh.type), axis = axis_of(face);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double cell_area = mesh.size[u] * mesh.size[v] / double(mesh.cells[u] * mesh.cells[v]);
    std::vector<double> weights(mesh.X.size());
    for (std::size_t first = 0; first < mesh.elements.size(); first += count) {
        // A tetrahedron has a triangle there, half a cell, if three of its nodes are there.
        std::size_t found = 0;
        for (std::size_t a = 0; a < count; ++a) found += on[mesh.elements[first + a]] ? 1 : 0;
        if (mesh.type == ElementType::tetrahedra && found < 3) continue;

        for (std::size_t a = 0; a < count; ++a) {
            const std::size_t node = mesh.elements[first + a];
            if (!on[node]) continue;
            weights[node] +=
                cell_area * (mesh.type == ElementType::tetrahedra ? 1.0 / 6 : face_share(mesh.type, a, axis));
        }
    }
    return weights;
}

Vec3 interpolate(const Mesh& mesh, const std::vector<Vec3>& values, const Vec3& point) {
    const std::size_t count = nodes_per_element(mesh.type);
    const std::size_t* nearest = nullptr;
    double least = 0;
    for (std::size_t first = 0; first < mesh.elements.size(); first += count) {
        const std::size_t* nodes = &mesh.elements[first];
        const double distance = outside(mesh.type, reference_coordinates(mesh, nodes, point));
        if (!nearest || distance < least) nearest = nodes, least = distance;
    }
    const Shape shape = shape_at(mesh.type, reference_coordinates(mesh, nearest, point));
    Vec3 value;
    for (std::size_t a = 0; a < count; ++a) value += shape.phi[a] * values[nearest[a]];
    return value;
}

Vec3 face_mean(const Mesh& mesh, const std::vector<Vec3>& values, Face face) {
    const std::vector<double> weights = face_weights(mesh, face);
    Vec3 sum;
    double area = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += weights[i] * values[i], area += weights[i];
    return sum / area;
}

}  // namespace phyxel::fem
