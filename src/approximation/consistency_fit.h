#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "approximation/consistency.h"
#include "base/simd.h"

namespace phyxel {

/// Linear functions v_k(e) = value[k] + slope[k] . e of e = (X - X_q)/h_q, orthonormal in the weights of one stencil:
/// sum_i w_i v_k(e_i) v_l(e_i) = delta_kl. They span {1, x, y, z} as far as the nodes of the stencil tell these apart
/// (unused ones are zero), so that S_q = W - sum_k (W v_k)(W v_k)^T is a projector whatever the rank.
struct LinearFit {
    std::array<double, 4> value{};
    std::array<Vec3, 4> slope{};

    double operator()(std::size_t k, const Vec3& e) const { return value[k] + dot(slope[k], e); }
};

/// The stencil of one point, spelled out.
struct WeightedStencil {
    std::span<const std::uint32_t> node;
    std::vector<Vec3> position;  // e_i = (X_i - X_q)/h_q
    std::vector<double> weight;  // w_i

    std::vector<Double4> linear;  // v_k(e_i), k = 0 to 3, filled by `evaluate`

    void load(const ConsistencyInput& input, std::size_t point);
    void evaluate(const LinearFit& fit);
    std::size_t size() const { return node.size(); }
};

/// The fit for nodes at `position` with weights `weight` [nodes each].
LinearFit fit_linear(std::span<const Vec3> position, std::span<const double> weight);

/// change_i = w_i (lambda_i - linear fit of lambda), that is S_q lambda. `lambda` holds one value per node of the
/// stencil and is overwritten; the stencil is left with `fit` evaluated.
void apply_projector(WeightedStencil& stencil, const LinearFit& fit, std::span<Vec3> lambda);

}  // namespace phyxel
