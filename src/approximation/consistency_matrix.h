#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "approximation/consistency_blocks.h"
#include "approximation/consistency_fit.h"

namespace phyxel {

/// S = sum_q V_q S_q over the nodes of the zone, in their new numbers, as compressed rows. Symmetric, positive
/// semidefinite; each row has a diagonal entry.
struct ConsistencyMatrix {
    std::vector<std::size_t> row;       // [zone nodes + 1]
    std::vector<std::uint32_t> column;  // [entries] ascending within a row
    std::vector<double> value;          // [entries] [m^3]
    std::vector<double> diagonal;       // [zone nodes]

    std::size_t size() const { return diagonal.size(); }
    /// y = S x, three columns at once.
    void multiply(std::span<const Vec3> x, std::span<Vec3> y, const Threads& threads) const;
};

ConsistencyMatrix assemble(const ConsistencyInput& input, std::span<const LinearFit> fits,
                           const ConsistencyBlocks& blocks, const Threads& threads);

}  // namespace phyxel
