#pragma once

#include "approximation/stencils.h"
#include "base/simd.h"
#include "material/law.h"

namespace phyxel {

/// The loops that nearly all time goes into: over pairs of points and nodes, and over points, for a run of points of
/// one block.

/// A point's 3x3 matrix as these loops keep it: column by column, not initialized.
struct Columns {
    Double4 column[3];

    explicit operator Mat3() const { return Mat3::from_columns(load(column[0]), load(column[1]), load(column[2])); }
    Columns& operator=(const Mat3& A) {
        for (std::size_t c = 0; c < 3; ++c) store(column[c], A.column(c));
        return *this;
    }
};

/// F_q = sum_i x_i (x) g_qi of the points [begin, end); `x` are the block's slots.
void gather_gradients(const Stencils& stencils, std::uint32_t begin, std::uint32_t end, const Double4* x, Columns* F);

/// A_q = V_q P(F_q) of `count` points.
void evaluate_stresses(const MaterialPoint& material, std::size_t count, const double* V, const Columns* F, Columns* A);

/// f_i -= A_q g_qi over the pairs of the points [begin, end); `f` are the block's slots.
void scatter_stresses(const Stencils& stencils, std::uint32_t begin, std::uint32_t end, const Columns* A, Double4* f);

}  // namespace phyxel
