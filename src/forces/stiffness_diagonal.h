#pragma once

#include <vector>

#include "model/model.h"

namespace phyxel {

/// [nodes] Diagonal 3x3 blocks of the stiffness at rest [N/m], stabilization included; of one point a node without the
/// part that corrected gradients add.
std::vector<Mat3> stiffness_diagonal(const Model& model, const Threads& threads);

}  // namespace phyxel
