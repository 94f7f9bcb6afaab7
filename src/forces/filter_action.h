#pragma once

#include <span>
#include <vector>

#include "base/float_lanes.h"
#include "model/model.h"

namespace phyxel {

/// Constant Hessian of the filter energy sum_i k_i/2 |[(I - Phi)^2 x]_i|^2 (approximation/node_filter.h) in single
/// precision, for preconditioners: H d = ((I - Phi)^T)^2 k (I - Phi)^2 d. The same bits for any number of threads.
/// Calls share work arrays: one at a time. Test: tests/forces/filter_action_test.cpp.
class FilterAction {
public:
    /// A model without filter gives zero.
    explicit FilterAction(const Model& model);

    /// Reads the stiffnesses of the model again.
    void set_materials(const Model& model);

    /// out += H d [N].
    void add(std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out) const;

private:
    /// Sparse matrix, row by row.
    struct Rows {
        std::vector<std::uint32_t> offset, column;
        std::vector<float> value;
    };
    static Rows rows_of(const SparseRows& rows);
    static Float4Lanes product(const Rows& rows, std::size_t i, const std::vector<Float4>& in);

    Rows rows_, columns_;           ///< of I - Phi and of its transpose
    std::vector<float> stiffness_;  ///< [nodes] k_i [N/m]
    mutable std::vector<Float4> a_, b_;
};

}  // namespace phyxel
