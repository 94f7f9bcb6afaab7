#pragma once

#include <vector>

#include "approximation/stencils.h"

namespace phyxel {

/// Sparse matrix, row by row, with its transpose, so that both products gather.
struct SparseRows {
    std::vector<std::uint32_t> offset;  ///< [rows + 1]
    std::vector<std::uint32_t> column;
    std::vector<double> value;
};

SparseRows transposed(const SparseRows& rows, std::size_t columns);

/// The smoothing Phi_ij = phi_j(X_i) of node coefficients: (I - Phi) x vanishes for linear fields and keeps what the
/// field hardly sees. Moving least squares smooth so strongly that a checkerboard of coefficients is almost invisible
/// to eight quadrature points a cell, 30 to 50 times too soft; the stabilization energy acts on (I - Phi)^2 x.
struct NodeFilter {
    SparseRows rows;     ///< of I - Phi
    SparseRows columns;  ///< of its transpose
};

NodeFilter build_filter(const Sampling& sampling, const ApproximationSettings& settings, const Threads& threads);

}  // namespace phyxel
