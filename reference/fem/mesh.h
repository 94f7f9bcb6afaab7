#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "phyxel/vector.h"
#include "reference/fem/element.h"

/// Structured meshes of a box with one corner at the origin.

namespace phyxel::fem {

/// How the boxes of the grid are cut into tetrahedra. Brunet et al. 2019, figure 7, compares `six` with a mirror image.
enum class Split {
    six,              ///< six around the diagonal from (0, 0, 0) to (1, 1, 1), the same in every box
    six_mirrored,     ///< `six` mirrored in x
    six_alternating,  ///< `six`, each box the mirror image of its neighbours
    five,             ///< four at corners and one in the middle, mirrored from box to box
};

enum class Face { x_min, x_max, y_min, y_max, z_min, z_max };

struct Mesh {
    ElementType type = ElementType::hexahedra_8;
    Split split = Split::six;            ///< of tetrahedra
    std::array<std::size_t, 3> cells{};  ///< boxes along x, y, z
    Vec3 size;                           ///< [m]
    std::vector<Vec3> X;                 ///< [nodes] rest positions [m], x fastest, then y
    std::vector<std::size_t> elements;   ///< [elements x nodes of one] node numbers, in the local order of element.h
};

/// The box [0, size] cut into `cells` boxes, each of them one hexahedron or five or six tetrahedra.
Mesh box_mesh(ElementType type, const std::array<std::size_t, 3>& cells, const Vec3& size, Split split = Split::six);

std::size_t element_count(const Mesh& mesh);

/// [nodes] whether each node lies on that face of the box, by its place in the grid.
std::vector<bool> nodes_on(const Mesh& mesh, Face face);

/// [nodes] integral of the shape function over that face [m^2]; they sum to its area.
std::vector<double> face_weights(const Mesh& mesh, Face face);

/// The field of nodal values at a rest point of the box: the element that holds it, interpolated. For the rest
/// positions that `box_mesh` gave.
Vec3 interpolate(const Mesh& mesh, const std::vector<Vec3>& values, const Vec3& point);

/// Mean of the field of nodal values over a face.
Vec3 face_mean(const Mesh& mesh, const std::vector<Vec3>& values, Face face);

}  // namespace phyxel::fem
