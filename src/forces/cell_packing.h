#pragma once

#include <span>
#include <vector>

#include "forces/cell_groups.h"
#include "forces/cell_kernel.h"

namespace phyxel {

enum class CellPoints {
    all,   ///< every quadrature point of a group
    mean,  ///< one for all of them, with their mean gradients: an eighth of the work
};

/// Gradients that uniform chunks of one shape, or similar chunks of one family, share.
struct CellShape {
    std::array<std::uint32_t, 9> pair_begin{};
    std::vector<std::uint16_t> entry;
    std::vector<float> gradient;
};

/// Those of the leaders, by the number of the shape and of the family; empty where too few groups share them.
struct CellShapes {
    std::vector<CellShape> exact, similar;
};

/// Groups near to each other, dealt to chunks, with slots for the nodes that they see. The chunks point into the
/// block's vectors, which a move keeps and a copy would not.
struct CellBlock {
    CellBlock() = default;
    CellBlock(CellBlock&&) = default;
    CellBlock& operator=(CellBlock&&) = default;

    std::vector<CellChunk> chunks;
    std::vector<std::uint32_t> lane_group;  ///< [chunks][lanes] group in a lane, `no_index` for none
    std::vector<std::uint32_t> slot_node;   ///< [slots] `no_index` for the first, which stands for missing nodes
    std::vector<std::uint16_t> slot, entry;
    std::vector<std::uint8_t> join;  ///< [chunks][lanes] where dilatation cells have several groups
    std::vector<float> gradient, lame, volume_stiffness, share;
    std::vector<std::int16_t> difference;
    bool moves = true;     ///< all of its laws follow rotations
    bool complete = true;  ///< no dilatation cell is cut
};

CellShapes pack_shapes(const Model& model, const CellGroups& groups, std::size_t lanes, CellPoints points,
                       const Threads& threads);

/// Packs the groups `members`, those of one kind and shape after each other, into chunks of so many lanes; moduli are
/// filled in later.
CellBlock pack_block(const Model& model, const CellGroups& groups, const CellShapes& shapes,
                     std::span<const std::uint32_t> members, std::size_t lanes, CellPoints points);

}  // namespace phyxel
