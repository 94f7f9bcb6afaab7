#pragma once

#include <span>
#include <vector>

#include "base/float_lanes.h"
#include "base/simd.h"
#include "base/threads.h"
#include "model/model.h"

namespace phyxel {

/// The stabilization of eight points a cell, U = sum_i k_i/2 |[(I - Phi)^2 x]_i|^2, in single precision. One call at a
/// time.
class FloatFilter {
public:
    explicit FloatFilter(const Model& model);

    bool empty() const { return stiffness_.empty(); }

    /// f -= dU/dx [N]; returns U [J].
    double add_forces(const Model& model, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f);
    /// U [J].
    double energy(const Model& model, std::span<const Vec3> x, const Threads& threads);
    /// out += share (I - Phi)^T k (I - Phi) d: one pass instead of two.
    void add_once_filtered(std::span<const Vec3f> d, float share, const Threads& threads, std::span<Vec3f> out);

private:
    /// I - Phi or its transpose.
    struct Rows {
        std::vector<std::uint32_t> offset{0}, column;
        std::vector<float> value;
        explicit Rows(const SparseRows& rows);
    };
    using Field = std::vector<Float4>;
    static void multiply(const Rows& rows, const Field& in, const Threads& threads, Field& out);
    /// first_ = (I - Phi) x and second_ = (I - Phi) first_; returns U.
    double filter(const Model& model, std::span<const Vec3> x, const Threads& threads);
    void stiffen(Field& field, const Threads& threads) const;  ///< times k

    Rows rows_, columns_;
    std::vector<float> stiffness_;  ///< [nodes] k [N/m]
    Field first_, second_;          ///< [nodes]
    std::vector<Double4> positions_;
};

}  // namespace phyxel
