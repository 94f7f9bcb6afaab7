#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "approximation/consistency.h"
#include "approximation/consistency_fit.h"

namespace phyxel {

/// The nodes that some point of the zone sees, renumbered so that nearby nodes have nearby numbers, and cut into
/// compact blocks of consecutive numbers.
struct ConsistencyBlocks {
    struct Block {
        std::uint32_t begin = 0, end = 0;  // in the new numbers
    };

    static constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> node;    // [zone nodes] number in the body
    std::vector<std::uint32_t> number;  // [nodes] number in the zone, or `none`
    std::vector<Vec3> position;         // [zone nodes] [m]
    std::vector<Block> blocks;
    std::vector<LinearFit> linear;               // [blocks] the linear functions of each, orthonormal on its nodes
    std::vector<std::uint32_t> component_begin;  // [components + 1] first node of each connected part

    std::size_t size() const { return node.size(); }
};

/// Blocks of at most `block_size` nodes, none of which reaches into two connected parts.
ConsistencyBlocks cut_into_blocks(const ConsistencyInput& input, std::size_t block_size);

}  // namespace phyxel
