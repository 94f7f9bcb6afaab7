#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/threads.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

/// A solid as sub-voxels, 4 x 4 x 4 in every octant of a lattice: one bit each, one 64-bit mask per octant. Octants
/// that the surface does not cross are whole or empty.

namespace phyxel {

class WindingNumber;

/// Masks over the 64 sub-voxels of an octant; sub-voxel (x, y, z) is bit 16 x + 4 y + z.
namespace sub_voxel {

using Mask = std::uint64_t;

constexpr Mask none = 0, all = ~Mask{0};
constexpr int per_edge = 4;
constexpr std::array<int, 3> stride{16, 4, 1};

/// Samples are taken next to the centres, in sub-voxels: models put their faces at round coordinates, and on a face
/// inside is not defined.
constexpr Vec3 sample_shift{3.1e-6, 1.7e-6, 2.3e-6};

constexpr int bit(int x, int y, int z) { return 16 * x + 4 * y + z; }

/// All sub-voxels whose coordinate along `axis` is `layer`.
constexpr Mask layer(std::size_t axis, int layer) {
    constexpr std::array<Mask, 3> lowest{0x000000000000ffff, 0x000f000f000f000f, 0x1111111111111111};
    return lowest[axis] << (layer * stride[axis]);
}

/// Those sub-voxels whose neighbour one step up (`step` = 1) or down (-1) an axis is set, in `mask` itself or, across
/// the face, in the octant next to it.
constexpr Mask with_neighbor(Mask mask, Mask next_octant, std::size_t axis, int step) {
    const int s = stride[axis];
    return step > 0 ? ((mask >> s) & ~layer(axis, 3)) | ((next_octant << 3 * s) & layer(axis, 3))
                    : ((mask << s) & ~layer(axis, 0)) | ((next_octant >> 3 * s) & layer(axis, 0));
}

/// Sum over the set sub-voxels of their coordinate along `axis`.
constexpr int coordinate_sum(Mask mask, std::size_t axis) {
    return std::popcount(mask & (layer(axis, 1) | layer(axis, 3))) +
           2 * std::popcount(mask & (layer(axis, 2) | layer(axis, 3)));
}

/// Mean centre of the set sub-voxels, in octants from the octant's lower corner.
inline Vec3 centroid(Mask mask) {
    Vec3 mean;
    for (std::size_t axis = 0; axis < 3; ++axis)
        mean[axis] = (static_cast<double>(coordinate_sum(mask, axis)) / std::popcount(mask) + 0.5) / per_edge;
    return mean;
}

}  // namespace sub_voxel

/// The octants of a mesh's bounding box and one empty layer around them.
struct OctantGrid {
    OctantGrid(const TriangleMesh& mesh, double edge);

    double pitch;               ///< [m] edge of an octant
    std::array<int, 3> first;   ///< index of the lowest octant
    std::array<int, 3> extent;  ///< octants along each axis

    std::size_t size() const { return stride(0) * static_cast<std::size_t>(extent[0]); }
    std::size_t stride(std::size_t axis) const {
        const auto depth = static_cast<std::size_t>(extent[2]), width = static_cast<std::size_t>(extent[1]);
        return axis == 0 ? width * depth : axis == 1 ? depth : 1;
    }
    std::size_t at(const std::array<int, 3>& index) const {
        std::size_t offset = 0;
        for (std::size_t c = 0; c < 3; ++c) offset += static_cast<std::size_t>(index[c] - first[c]) * stride(c);
        return offset;
    }
    Vec3 corner(const std::array<int, 3>& index) const {
        return {index[0] * pitch, index[1] * pitch, index[2] * pitch};
    }

    /// Calls `visit(index, at(index))` for the octants of plane i, without the empty layer.
    template <class Visit>
    void visit_plane(int i, Visit&& visit) const {
        for (int j = first[1] + 1; j < first[1] + extent[1] - 1; ++j) {
            std::size_t octant = at({i, j, first[2] + 1});
            for (int k = first[2] + 1; k < first[2] + extent[2] - 1; ++k) visit(std::array<int, 3>{i, j, k}, octant++);
        }
    }
    /// Calls `visit(i)` for the planes without the empty layer, side by side.
    template <class Visit>
    void for_planes(const Threads& threads, Visit&& visit) const {
        threads.for_each(static_cast<std::size_t>(extent[0]) - 2, 1,
                         [&](std::size_t n) { visit(first[0] + 1 + static_cast<int>(n)); });
    }
};

struct SubVoxels {
    OctantGrid grid;
    std::vector<sub_voxel::Mask> masks;  ///< [grid.size()]
};

/// Sub-voxels whose centre has a positive winding number, counted along lines through the surface: fast, and exact for
/// surfaces that are closed. Nothing when some line enters the surface and does not leave it.
std::optional<SubVoxels> sub_voxels_by_columns(const TriangleMesh& mesh, double pitch, const Threads& threads);

/// Sub-voxels at whose centre the winding number exceeds 1/2. Octants that hold no surface are whole or empty by one
/// sample, except where the solid ends without surface, as in the holes of an open mesh.
SubVoxels sub_voxels_by_winding_number(const TriangleMesh& mesh, const WindingNumber& winding, double pitch,
                                       const Threads& threads);

/// By columns where the surface allows it, else by the winding number: the same sub-voxels on a closed surface.
SubVoxels make_sub_voxels(const TriangleMesh& mesh, const WindingNumber& winding, double pitch, const Threads& threads);

}  // namespace phyxel
