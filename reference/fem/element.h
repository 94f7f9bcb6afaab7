#pragma once

#include <cstddef>
#include <vector>

#include "phyxel/vector.h"

/// The three elements that Brunet et al. 2019 compare with: shape functions and quadrature in reference coordinates.
/// Hexahedra live in [-1, 1]^3, local node (a, b, c) has number a + n (b + n c), n nodes an edge; tetrahedra have the
/// corners (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1). Test: tests/reference/fem_test.cpp.

namespace phyxel::fem {

enum class ElementType {
    tetrahedra,    ///< 4 nodes, linear, one quadrature point
    hexahedra_8,   ///< 8 nodes, trilinear, 2^3 Gauss points
    hexahedra_27,  ///< 27 nodes, triquadratic, 3^3 Gauss points
};

/// Shape values and their derivatives by the reference coordinates at one point; one entry a local node.
struct Shape {
    std::vector<double> phi;
    std::vector<Vec3> slope;
};

/// A quadrature point in reference coordinates; the weights sum to the reference volume (8, or 1/6).
struct ReferencePoint {
    Vec3 xi;
    double weight = 0;
};

std::size_t nodes_per_edge(ElementType type);
std::size_t nodes_per_element(ElementType type);

Shape shape_at(ElementType type, const Vec3& xi);

/// Full integration of the stiffness of an undistorted element.
std::vector<ReferencePoint> stiffness_quadrature(ElementType type);

/// Exact for products of two shape functions on an undistorted element: the consistent mass.
std::vector<ReferencePoint> mass_quadrature(ElementType type);

}  // namespace phyxel::fem
