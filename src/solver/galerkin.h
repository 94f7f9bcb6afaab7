#pragma once

#include <array>
#include <vector>

#include "approximation/node_filter.h"
#include "model/model.h"
#include "solver/block_matrix.h"

namespace phyxel {

/// Trilinear interpolation from a lattice of twice the spacing: row i holds the coarse nodes that node i lies between,
/// with their weights, which add up to 1.
struct Coarsening {
    SparseRows prolongation;                          ///< [fine nodes]
    SparseRows restriction;                           ///< its transpose, [coarse nodes]
    std::vector<std::array<std::int32_t, 3>> places;  ///< [coarse nodes] integer places, in coarse spacings
    std::vector<std::uint32_t> parts;                 ///< [coarse nodes]
};

/// Coarse nodes for fine ones at `places` [fine spacings from some corner], which belong to `parts` of the body that
/// touch nowhere: coarse nodes are of one part each, else the coarse lattices would tie the parts together.
Coarsening coarsen(std::span<const Vec3> places, std::span<const std::uint32_t> parts);

/// [nodes] number of the part that each node belongs to: cells that touch are of one part.
std::vector<std::uint32_t> separate_parts(const Sampling& sampling);

/// P^T K P of the stiffness at rest, K without the stabilization, which smooth fields hardly feel. `free` [nodes] masks
/// held components. Assembled from coarse stencils, sum_i P_iI g_qi, not from K. The model shares no dilatations.
BlockRows galerkin_stiffness(const Model& model, const Coarsening& coarse, std::span<const Vec3> free,
                             const Threads& threads);

/// P^T A P.
BlockRows galerkin_product(const BlockMatrix& A, const Coarsening& coarse);

}  // namespace phyxel
