#pragma once

#include "approximation/stencils.h"
#include "base/simd.h"

namespace phyxel {

/// The two loops over pairs of points and nodes that nearly all time goes into, for a run of points of one block.

/// F_q = sum_i x_i (x) g_qi of the points [begin, end); `x` are the block's slots.
void gather_gradients(const Stencils& stencils, std::uint32_t begin, std::uint32_t end, const Double4* x, Mat3* F);

/// f_i -= A_q g_qi over the pairs of the points [begin, end); `f` are the block's slots.
void scatter_stresses(const Stencils& stencils, std::uint32_t begin, std::uint32_t end, const Mat3* A, Double4* f);

}  // namespace phyxel
