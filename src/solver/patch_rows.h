#pragma once

#include <memory>
#include <span>
#include <vector>

#include "forces/constraints.h"
#include "solver/galerkin.h"

namespace phyxel {

/// Penalties sum_r k_r/2 |C_r x|^2 of patch averages on one level of a hierarchy, each with its own coefficients in the
/// three directions.
class PatchRows {
public:
    PatchRows() = default;
    PatchRows(const Constraints& constraints, std::span<const Vec3> free);

    bool empty() const { return stiffness_.empty(); }
    PatchRows coarsened(const Coarsening& coarse) const;

    /// out += C^T k C d.
    void add_action(const std::vector<Vec3f>& d, std::vector<Vec3f>& out) const;
    void add_to(BlockRows& rows) const;

private:
    friend class BlockJacobi;
    std::vector<std::uint32_t> offset_{0}, node_;
    std::vector<Vec3> coefficient_;
    std::vector<Vec3> stiffness_;  ///< [rows] [N/m]
};

/// Inverse of D + C^T k C, D block diagonal, by Woodbury's formula. (With the penalties in the diagonal alone, a row of
/// fifty nodes would raise the largest eigenvalue fiftyfold and leave nothing to smooth.)
class BlockJacobi {
public:
    BlockJacobi();
    ~BlockJacobi();
    BlockJacobi(BlockJacobi&&) noexcept;
    BlockJacobi& operator=(BlockJacobi&&) noexcept;
    BlockJacobi(std::span<const Mat3> diagonal, const PatchRows& patches);

    /// z = (D + C^T k C)^-1 r.
    void apply(const std::vector<Vec3f>& r, std::vector<Vec3f>& z, const Threads& threads) const;

private:
    struct Patches;
    std::vector<Mat3f> inverse_;
    std::unique_ptr<Patches> patches_;
};

}  // namespace phyxel
