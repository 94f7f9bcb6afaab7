#pragma once

#include <vector>

#include "sampling/sampling.h"

namespace phyxel {

/// Finds the nodes in the support of a point by walking over touching cells, breadth first, within 1.25 support radii:
/// what lies across a gap is never reached. One object a thread.
///
/// Searches from the same cell follow each other: the surroundings of the last cell are kept as a small graph, cells
/// and nodes as bits, so that a search is a few distances and a flood of bits.
class SupportSearch {
public:
    explicit SupportSearch(const Sampling& sampling);

    /// Nodes closer than `radius` to `position` (lattice frame), reachable from `cell`; ascending.
    const std::vector<std::uint32_t>& find(const Vec3& position, std::uint32_t cell, double radius);

private:
    using Word = std::uint64_t;

    /// All that a search from `cell` may meet: cells whose centres are within `reach` of its own.
    struct Surroundings {
        std::uint32_t cell = no_index;
        double reach = 0;                                ///< [m]
        std::vector<std::uint32_t> cells;                ///< as walked: the first is `cell`
        std::vector<Vec3> centers;                       ///< [cells] [m]
        std::vector<std::uint32_t> nodes;                ///< of the cells; ascending
        std::vector<Vec3> positions;                     ///< [nodes] [m]
        std::vector<std::array<std::uint32_t, 2>> held;  ///< [cells] places of their nodes in `nodes`, or `no_index`
        std::vector<Word> touching;                      ///< [cells] rows of one bit a cell
    };

    void look_around(std::uint32_t cell, double reach);

    const Sampling& sampling_;
    std::vector<std::uint32_t> local_;       ///< [cells] place in the surroundings, or `no_index`
    std::vector<std::uint32_t> local_node_;  ///< [nodes] place in the surroundings; only of nodes that are in them
    Surroundings around_;
    std::vector<Word> near_, reached_, frontier_, next_, held_;
    std::vector<std::uint32_t> found_;
};

/// Whether the smallest variance of node positions under the kernel's weights exceeds `least` [m^2].
bool varies_more_than(double least, std::span<const Vec3> offsets, KernelShape kernel, double radius);

/// The nodes around one point, with the support radius that a sound fit needs.
struct Support {
    std::vector<std::uint32_t> nodes;  ///< ascending
    std::vector<Vec3> offsets;         ///< [nodes] node minus point [m]
    double radius = 0;                 ///< [m]
    bool widened = false;
};

/// Collects the support of a point: at least eight nodes whose smallest weighted variance exceeds 1e-2 a^2, else the
/// radius is widened by 1.12, at most twelve times; after that what is there must do. A point that reaches no node at
/// all (a speck of its own) gets the nearest one.
void find_support(SupportSearch& search, const Sampling& sampling, KernelShape kernel, double radius,
                  const Vec3& position, std::uint32_t cell, Support& out);

}  // namespace phyxel
