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

/// Gradients that the uniform chunks of one shape share.
struct CellShape {
    std::array<std::uint32_t, 9> pair_begin{};
    std::vector<std::uint16_t> entry;
    std::vector<float> gradient;
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
    bool moves = true;     ///< all of its laws follow rotations
    bool complete = true;  ///< no dilatation cell is cut
};

CellShape pack_shape(const Model& model, const CellGroups& groups, const CellGroups::Group& group, CellPoints points);

/// Packs the groups `members`, those of one kind and shape after each other, into chunks of so many lanes; moduli are
/// filled in later.
CellBlock pack_block(const Model& model, const CellGroups& groups, std::span<const CellShape> shapes,
                     std::span<const std::uint32_t> members, std::size_t lanes, CellPoints points);

}  // namespace phyxel
