#pragma once

#include <memory>
#include <vector>

#include "forces/constraints.h"
#include "forces/internal_forces.h"
#include "forces/rest_stiffness.h"
#include "solver/patch_rows.h"

namespace phyxel {

/// Approximate inverse of A = s K(rest) + c M + penalties by one V-cycle of geometric multigrid: lattices of twice,
/// four times ... the spacing with trilinear interpolation and Galerkin operators, smoothed by a step of damped block
/// Jacobi before and after, and a Cholesky factor where few unknowns are left; in single precision. Symmetric and
/// positive definite. Held components stay zero.
///
/// The body at rest serves for all of its deformed states, in frames turned with the nodes (`WarpedPreconditioner`).
class RestMultigrid {
public:
    RestMultigrid(const Model& model, const Constraints& constraints, const Threads& threads);
    ~RestMultigrid();
    RestMultigrid(RestMultigrid&&) noexcept;

    /// Sets s and c [1/s^2]; when they changed, the operators are put together anew, without supports.
    void set_weights(double stiffness, double inertia, const Threads& threads);

    /// Adds `blocks` [nodes], symmetric and semidefinite, to the diagonal of A; empty: none.
    void set_supports(std::vector<Mat3> blocks);

    /// The residual r to be filled in, and the result z = V r after `cycle`, both [nodes].
    std::vector<Vec3f>& residual();
    const std::vector<Vec3f>& result() const;
    void cycle(const Threads& threads) { cycle(0, threads); }

    std::span<const Vec3> free() const { return free_; }  ///< [nodes] 1 for components that may move, else 0

private:
    struct Level;
    struct CoarseFactor;

    void assemble(std::size_t level);
    void factorize();
    void multiply(std::size_t level, const std::vector<Vec3f>& d, std::vector<Vec3f>& out, const Threads& threads);
    void smooth(std::size_t level, bool from_zero, const Threads& threads);
    void cycle(std::size_t level, const Threads& threads);
    double largest_eigenvalue(std::size_t level, const Threads& threads);

    const Model& model_;
    std::unique_ptr<RestStiffness> fast_;  ///< null: in double
    std::vector<Vec3> free_;
    std::vector<Mat3> diagonal_;  ///< [nodes] of K(rest)
    std::vector<Level> levels_;   ///< [0] the nodes themselves
    std::unique_ptr<CoarseFactor> factor_;
    double stiffness_ = 0, inertia_ = -1;
    ForceWorkspace work_;  ///< where the stiffness is in double
    std::vector<Vec3> wide_d_, wide_out_;
};

}  // namespace phyxel
