#pragma once

#include "model/model.h"

namespace phyxel {

/// Poisson's ratio above which points share their dilatation unless the settings say otherwise. Below it the beams of
/// Brunet et al. 2019 bend within half a per cent without.
inline constexpr double nearly_incompressible = 0.47;

/// Groups the points of the nearly incompressible materials of a model, or of all or none of them if `wanted` says so.
/// A group is what lies in one cell of the lattice between nodes (in one conventional cell of a body-centred lattice),
/// hangs together and is mostly of one material. With points at the nodes there is one point a cell: no groups.
DilatationCells group_points(const Model& model, std::optional<bool> wanted);

}  // namespace phyxel
