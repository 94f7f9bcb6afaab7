#pragma once

#include "phyxel/mesh.h"

namespace phyxel {

/// The same surface of smaller triangles: edges longer than `longest` are halved until none is, for the triangles on
/// both sides alike, so that a closed surface stays closed. The vertices of `mesh` come first.
TriangleMesh refined(TriangleMesh mesh, double longest);

}  // namespace phyxel
