#pragma once

#include "sampling/sampling.h"

namespace phyxel {

/// Puts a node into every cell filled to at least `share`, at the centre of its box.
void place_cubic_nodes(Sampling& sampling, std::span<const double> cell_volume, double share);

/// Puts a node at every corner and centre of the conventional cells around which the solid fills at least `share` of a
/// node's volume; one for each of the groups of touching cells that meet there.
void place_bcc_nodes(Sampling& sampling, std::span<const double> cell_volume, double share);

/// How many nodes a clipped volume gets, not counting splits by gaps.
std::size_t count_nodes(const ClippedVolume& clipped, Lattice lattice, double share);

}  // namespace phyxel
