#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads.h"
#include "geometry/clipping.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

/// The connected parts of the solid within the boxes around lattice nodes. A lattice that knows only which nodes are
/// near welds whatever is closer than a support: the fingers of a hand, two plates with a gap. Here every part of a box
/// is a cell of its own, and cells are neighbours only where the solid itself passes from one to the other.

namespace phyxel {

struct CellComponents {
    /// One connected part of the solid in one node box. Box (I, J, K) is the cube of edge 2 pitch around the node at
    /// (I, J, K) 2 pitch; octant i belongs to box (i + 1) >> 1, along each axis.
    struct Cell {
        std::array<int, 3> box{};
        double volume = 0;  ///< [m^3]
        Vec3 centroid;      ///< [m]
    };
    /// One cell's part of one octant. The pieces of an octant add up to its volume and first moment.
    struct Piece {
        std::array<int, 3> octant{};
        std::uint32_t cell = 0;
        double volume = 0;  ///< [m^3]
        Vec3 centroid;      ///< [m]
    };

    std::vector<Cell> cells;                     ///< sorted by box (I, J, K); parts of a box by their lowest octant
    std::vector<Piece> pieces;                   ///< sorted by cell, then by octant (i, j, k)
    std::vector<std::uint32_t> neighbor_offset;  ///< [cells + 1] into `neighbors`
    std::vector<std::uint32_t> neighbors;        ///< cells that the solid joins to this one, ascending; symmetric
    std::size_t split_boxes = 0;                 ///< boxes of more than one cell
};

/// Parts are told apart by the sub-voxels, 8 x 8 x 8 a box, whose centre is inside: those that share a face belong
/// together, which keeps apart what is an eighth of a box apart. What is too thin for that (an octant that holds solid
/// but no centre, voxels that touch at edges only) is joined to the parts of adjacent octants to which a straight line
/// leads without crossing the surface. A sliver that sees none of them is joined to one, so that it is not lost and
/// joins nothing else.
CellComponents find_components(const TriangleMesh& mesh, const ClippedVolume& clip, const Threads& threads);

}  // namespace phyxel
