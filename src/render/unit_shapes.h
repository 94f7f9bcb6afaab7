#pragma once

#include <vector>

#include "phyxel/mesh.h"

namespace phyxel {

/// A shape with its normals, ready to be drawn.
struct ShapeMesh {
    std::vector<Vec3f> positions, normals;
    std::vector<Triangle> triangles;
};

ShapeMesh unit_sphere();  ///< radius 1 about the origin, smooth
ShapeMesh unit_cube();    ///< sides 1 about the origin, sharp edges
ShapeMesh unit_square();  ///< in the plane z = 0, x and y from -1 to 1

}  // namespace phyxel
