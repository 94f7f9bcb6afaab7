#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "approximation/consistency_blocks.h"
#include "approximation/consistency_fit.h"
#include "approximation/consistency_panel.h"

namespace phyxel {

/// S = sum_q V_q S_q over the nodes of the zone, in their new numbers: the rows of each block as a dense matrix over
/// the nodes that they meet. Symmetric and positive semidefinite up to single precision, in which it is kept; whoever
/// solves with it begins anew from exact residuals.
struct ConsistencyMatrix {
    struct Rows {
        std::vector<std::uint32_t> column;  // [columns] ascending; the block's own nodes are one run of them
        std::size_t own = 0;                // where that run begins
        Panel value;                        // [m^3]
    };
    std::vector<Rows> rows;        // [blocks]
    std::vector<double> diagonal;  // [zone nodes] [m^3]

    std::size_t size() const { return diagonal.size(); }
    /// y = S x, three columns at once. Each block takes the linear function that fits `x` on it away first, which S
    /// would annihilate: rounding then counts against what is left, and not against the large smooth part.
    void multiply(const ConsistencyBlocks& blocks, std::span<const Vec3> x, std::span<Vec3> y,
                  const Threads& threads) const;
};

ConsistencyMatrix assemble(const ConsistencyInput& input, std::span<const LinearFit> fits,
                           const ConsistencyBlocks& blocks, const Threads& threads);

}  // namespace phyxel
