#pragma once

#include "phyxel/mesh.h"

namespace phyxel {

/// Nodes that a body of this volume and area gets at `spacing`: those inside, and half a layer outside of the surface.
/// `per_cell`: nodes in a cell of edge `spacing`, 1 or 2.
double estimate_nodes(const MeshReport& mesh, double spacing, double per_cell);

/// Throws `Error` with a workable spacing when a body would need more memory than the machine has left.
void guard_memory(const MeshReport& mesh, double pitch, double spacing, double per_cell);

}  // namespace phyxel
