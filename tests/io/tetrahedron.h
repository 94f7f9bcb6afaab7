#pragma once

#include <vector>

#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// The smallest solid, for the tests of what is written.
inline const std::vector<Vec3f> tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline const std::vector<Triangle> tetrahedron_faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

}  // namespace phyxel
