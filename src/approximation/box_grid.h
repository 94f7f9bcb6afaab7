#pragma once

#include "sampling/sampling.h"

namespace phyxel {

/// Looks up cells by the lattice index of their box, in a dense array over the body's bounding box.
class BoxGrid {
public:
    explicit BoxGrid(const Sampling& sampling);

    /// First cell in that box, or `no_index`.
    std::uint32_t cell(const std::array<std::int32_t, 3>& box) const;

    /// [cells] whether every box within `reach` (largest coordinate difference) is whole, regular and touches its six
    /// neighbours: the surroundings of a point in such a cell are those of the infinite lattice.
    std::vector<char> deep_cells(const Sampling& sampling, int reach) const;

private:
    std::size_t index(const std::array<std::int32_t, 3>& box) const;

    std::array<std::int32_t, 3> low_{}, size_{};
    std::vector<std::uint32_t> first_;
};

/// Sorts the points of `sampling` so that those of one block of about `edge`^3 boxes follow each other; returns where
/// each block begins, and the number of points at the end.
std::vector<std::uint32_t> sort_into_blocks(Sampling& sampling, int edge);

}  // namespace phyxel
