#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/clipping.h"
#include "geometry/line_of_sight.h"
#include "geometry/sub_voxels.h"

/// The parts of the solid in one node box, its eight octants.

namespace phyxel {

/// The clipped octants, found by their place in the grid.
struct OctantMap {
    static constexpr std::uint32_t absent = 0xffffffff;

    OctantMap(const ClippedVolume& clipped, const SubVoxels& sub_voxels);

    /// Sub-voxels of a clipped octant.
    sub_voxel::Mask mask(std::uint32_t octant) const {
        return voxels.masks[voxels.grid.at(clip.octants[octant].index)];
    }

    const ClippedVolume& clip;
    const SubVoxels& voxels;
    std::vector<std::uint32_t> octant_at;  ///< [grid.size()] index into clip.octants, or absent
};

/// One connected part of a box. Octant (2 I - 1 + x, ...) of box I is number 4 x + 2 y + z: ascending (i, j, k).
struct BoxPart {
    std::array<int, 3> box{};
    std::array<std::uint32_t, 8> octants{};  ///< of the box, into clip.octants; OctantMap::absent without solid
    std::array<sub_voxel::Mask, 8> masks{};  ///< this part's sub-voxels
    std::array<bool, 8> present{};           ///< where this part has solid; without sub-voxels it is a sliver
    int sub_voxels() const;
};

/// A part's share of one octant.
struct Share {
    std::uint32_t octant;  ///< into clip.octants
    sub_voxel::Mask mask;  ///< none: a sliver
};

/// Two parts of which one has fewer sub-voxels than this may be one that the sub-voxels are too coarse to show whole.
constexpr int small_part = 64;

/// Whether a straight line inside the solid joins two shares: between their nearest sub-voxels, a sliver standing as
/// its centroid.
bool joined_by_line(const OctantMap& map, const LineOfSight& sight, const Share& a, const Share& b);

/// The parts of a box, by their lowest octant; none when the box holds no solid.
void append_box_parts(const OctantMap& map, const LineOfSight& sight, const std::array<int, 3>& box,
                      std::vector<BoxPart>& parts);

}  // namespace phyxel
