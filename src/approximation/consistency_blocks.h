#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "approximation/consistency.h"

namespace phyxel {

/// The nodes that some point of the zone sees, renumbered so that nearby nodes have nearby numbers, and cut into
/// compact blocks of consecutive numbers.
struct ConsistencyBlocks {
    struct Block {
        std::uint32_t begin = 0, end = 0;     // own nodes, in the new numbers
        Vec3 low, high;                       // box around them [m]
        std::uint32_t component = 0;          // the connected part it belongs to
        std::vector<std::uint32_t> extended;  // own nodes and those of the same part within the overlap, ascending
    };

    static constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> node;    // [zone nodes] number in the body
    std::vector<std::uint32_t> number;  // [nodes] number in the zone, or `none`
    std::vector<Vec3> position;         // [zone nodes] [m]
    std::vector<Block> blocks;
    std::vector<std::uint32_t> component_begin;      // [components + 1] first node of each connected part
    std::vector<std::uint32_t> blocks_in_component;  // [components]

    std::size_t size() const { return node.size(); }
};

/// Blocks of at most `block_size` nodes, extended by `overlap` [m] to all sides.
ConsistencyBlocks cut_into_blocks(const ConsistencyInput& input, std::size_t block_size, double overlap,
                                  const Threads& threads);

}  // namespace phyxel
