#pragma once

#include "forces/cell_blocks.h"

namespace phyxel {

/// Internal forces and rest stiffness of bodies with grid quadrature in single precision, elastic part and
/// stabilization: what implicit steps work with. Agrees with `internal_forces` and `stiffness_action` to a few 1e-6 of
/// the largest force. One call at a time.
class FastForces {
public:
    /// Whether a model can be had this way: eight points a cell, and no dilatation shared by more points than fit.
    static bool apply_to(const Model& model, const CellBlocks& cells) {
        return model.nodal.kappa.empty() && cells.matches_model();
    }

    FastForces(const Model& model, CellBlocks cells);

    /// f = -d(elastic + stabilization energy)/dx [N].
    void forces(const Model& model, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f);
    /// Elastic and stabilization energy [J].
    double energy(const Model& model, std::span<const Vec3> x, const Threads& threads);
    /// K d [N] at rest.
    void rest_action(const Model& model, std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out);

private:
    /// I - Phi or its transpose.
    struct Rows {
        std::vector<std::uint32_t> offset{0}, column;
        std::vector<float> value;
        Rows() = default;
        explicit Rows(const SparseRows& rows);
    };
    static Float4Lanes product(const Rows& rows, std::size_t i, const std::vector<Float4>& in);
    /// first_ = (I - Phi) x and second_ = (I - Phi) first_.
    void filter(const Model& model, std::span<const Vec3> x, const Threads& threads);
    void filter_twice(const Threads& threads);  ///< the latter alone
    /// Hands (I - Phi)^T (I - Phi)^T stiffness second_ to `add`.
    template <class Add>
    void spread_filtered(const Threads& threads, Add&& add);

    CellBlocks cells_;
    Rows rows_, columns_;
    std::vector<float> stiffness_;        ///< [nodes] of the filter [N/m]
    std::vector<Float4> first_, second_;  ///< [nodes]
};

}  // namespace phyxel
