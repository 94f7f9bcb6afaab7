#include "reference/fem/element.h"

#include <cmath>

namespace phyxel::fem {
namespace {

/// Lagrange polynomials of one coordinate in [-1, 1] and their derivatives, nodes evenly spaced.
struct Lagrange {
    double value[3];
    double slope[3];
};

Lagrange lagrange(std::size_t nodes, double x) {
    if (nodes == 2) return {{0.5 * (1 - x), 0.5 * (1 + x), 0}, {-0.5, 0.5, 0}};
    return {{0.5 * x * (x - 1), 1 - x * x, 0.5 * x * (x + 1)}, {x - 0.5, -2 * x, x + 0.5}};
}

Shape hexahedron_shape(std::size_t n, const Vec3& xi) {
    const Lagrange x = lagrange(n, xi.x), y = lagrange(n, xi.y), z = lagrange(n, xi.z);
    Shape shape;
    for (std::size_t c = 0; c < n; ++c)
        for (std::size_t b = 0; b < n; ++b)
            for (std::size_t a = 0; a < n; ++a) {
                shape.phi.push_back(x.value[a] * y.value[b] * z.value[c]);
                shape.slope.push_back({x.slope[a] * y.value[b] * z.value[c], x.value[a] * y.slope[b] * z.value[c],
                                       x.value[a] * y.value[b] * z.slope[c]});
            }
    return shape;
}

/// Gauss-Legendre points and weights on [-1, 1], two or three of them.
std::vector<std::pair<double, double>> gauss(std::size_t points) {
    if (points == 2) return {{-1 / std::sqrt(3.0), 1}, {1 / std::sqrt(3.0), 1}};
    return {{-std::sqrt(0.6), 5.0 / 9}, {0, 8.0 / 9}, {std::sqrt(0.6), 5.0 / 9}};
}

std::vector<ReferencePoint> gauss_box(std::size_t points) {
    std::vector<ReferencePoint> box;
    for (const auto& [z, wz] : gauss(points))
        for (const auto& [y, wy] : gauss(points))
            for (const auto& [x, wx] : gauss(points)) box.push_back({{x, y, z}, wx * wy * wz});
    return box;
}

}  // namespace

std::size_t nodes_per_edge(ElementType type) { return type == ElementType::hexahedra_27 ? 3 : 2; }

std::size_t nodes_per_element(ElementType type) {
    const std::size_t n = nodes_per_edge(type);
    return type == ElementType::tetrahedra ? 4 : n * n * n;
}

Shape shape_at(ElementType type, const Vec3& xi) {
    if (type != ElementType::tetrahedra) return hexahedron_shape(nodes_per_edge(type), xi);
    return {{1 - xi.x - xi.y - xi.z, xi.x, xi.y, xi.z}, {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

std::vector<ReferencePoint> stiffness_quadrature(ElementType type) {
    if (type == ElementType::tetrahedra) return {{{0.25, 0.25, 0.25}, 1.0 / 6}};
    return gauss_box(nodes_per_edge(type));
}

std::vector<ReferencePoint> mass_quadrature(ElementType type) {
    if (type != ElementType::tetrahedra) return gauss_box(nodes_per_edge(type));
    // Four points, exact to degree 2 (Zienkiewicz and Taylor, table 6.3).
    const double a = (5 - std::sqrt(5.0)) / 20, b = (5 + 3 * std::sqrt(5.0)) / 20;
    return {{{a, a, a}, 1.0 / 24}, {{b, a, a}, 1.0 / 24}, {{a, b, a}, 1.0 / 24}, {{a, a, b}, 1.0 / 24}};
}

}  // namespace phyxel::fem
