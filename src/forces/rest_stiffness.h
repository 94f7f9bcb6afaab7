#pragma once

#include "forces/cell_blocks.h"
#include "forces/float_filter.h"

namespace phyxel {

/// The stiffness of a body at rest as a preconditioner needs it, a quarter of the work of the exact one: one point a
/// lattice cell, with the mean gradients of its eight, cells that share gradients where these are close, and one pass
/// of the stabilizing filter instead of two; a little stiffer than the body. What one point does not see is what the
/// stabilization is for, so that nothing gets soft; implicit steps take as many iterations as with the exact stiffness.
class RestStiffness {
public:
    /// Models of one point a node cannot be had this way.
    static bool applies_to(const Model& model) { return model.nodal.kappa.empty(); }

    RestStiffness(const Model& model, const Threads& threads);

    /// out = K d [N], nearly.
    void apply(const Model& model, std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out);

private:
    CellBlocks cells_;
    FloatFilter filter_;
};

}  // namespace phyxel
