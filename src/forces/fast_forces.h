#pragma once

#include "forces/cell_blocks.h"
#include "forces/float_filter.h"

namespace phyxel {

/// Internal forces of bodies with grid quadrature in single precision, elastic part and stabilization: what implicit
/// steps work with. Agrees with `internal_forces` to a few 1e-6 of the largest force. One call at a time.
class FastForces {
public:
    /// Whether a model can be had this way: eight points a cell, and no dilatation shared by more points than fit.
    static bool apply_to(const Model& model, const CellBlocks& cells) {
        return model.nodal.kappa.empty() && cells.matches_model();
    }

    FastForces(const Model& model, CellBlocks cells) : cells_(std::move(cells)), filter_(model) {}

    /// f = -dU/dx [N], U the elastic and stabilization energy; returns U [J].
    double forces(const Model& model, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f);
    /// The same with the viscous forces of the velocities v [m/s], beta > 0 [s]; see `internal_forces`.
    void damped_forces(const Model& model, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                       const Threads& threads, std::span<Vec3> f);
    /// U [J].
    double energy(const Model& model, std::span<const Vec3> x, const Threads& threads);

private:
    CellBlocks cells_;
    FloatFilter filter_;
    std::vector<Vec3> ahead_;  ///< [nodes] x + beta v
};

}  // namespace phyxel
