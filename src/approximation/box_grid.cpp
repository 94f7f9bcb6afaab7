#include "approximation/box_grid.h"

#include <algorithm>
#include <numeric>

namespace phyxel {
namespace {

using Index3 = std::array<std::int32_t, 3>;

/// Grows the marked boxes by `reach` along one axis of a dense array: a box is marked if any within reach is.
void dilate(std::vector<char>& marks, const Index3& size, int axis, int reach) {
    const std::size_t stride = axis == 0 ? 1 : axis == 1 ? std::size_t(size[0]) : std::size_t(size[0]) * size[1];
    std::vector<char> line(size[axis]);
    for (std::size_t start = 0; start < marks.size(); ++start) {
        if (start / stride % size[axis] != 0) continue;
        for (std::int32_t i = 0; i < size[axis]; ++i) line[i] = marks[start + i * stride];
        for (std::int32_t i = 0; i < size[axis]; ++i) {
            const auto begin = line.begin() + std::max(0, i - reach),
                       end = line.begin() + std::min(size[axis], i + reach + 1);
            marks[start + i * stride] = std::find(begin, end, char{1}) != end;
        }
    }
}

/// [cells] cells that are cut, or do not touch six neighbours.
std::vector<char> irregular_cells(const Sampling& s) {
    std::vector<char> irregular(s.cell_box.size()), irregular_node(s.nodes.size());
    for (std::size_t c = 0; c < irregular.size(); ++c)
        irregular[c] = s.neighbor_offset[c + 1] - s.neighbor_offset[c] != 6;
    for (std::size_t q = 0; q < s.points.size(); ++q) {
        if (s.point_kind[q] != Sampling::irregular) continue;
        irregular[s.point_cell[q]] = 1;
        if (s.point_node[q] != no_index) irregular_node[s.point_node[q]] = 1;
    }
    for (std::size_t c = 0; c < irregular.size(); ++c)
        for (std::uint32_t n : s.cell_nodes[c])
            if (n != no_index && irregular_node[n]) irregular[c] = 1;
    return irregular;
}

template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
    std::vector<T> sorted(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
    values = std::move(sorted);
}

}  // namespace

BoxGrid::BoxGrid(const Sampling& s) {
    Index3 high = low_ = s.cell_box.front();
    for (const Index3& box : s.cell_box)
        for (int c = 0; c < 3; ++c) low_[c] = std::min(low_[c], box[c]), high[c] = std::max(high[c], box[c]);
    for (int c = 0; c < 3; ++c) size_[c] = high[c] - low_[c] + 1;
    first_.assign(std::size_t(size_[0]) * size_[1] * size_[2], no_index);
    for (std::uint32_t c = static_cast<std::uint32_t>(s.cell_box.size()); c-- > 0;) first_[index(s.cell_box[c])] = c;
}

std::size_t BoxGrid::index(const Index3& box) const {
    return (box[0] - low_[0]) +
           std::size_t(size_[0]) * ((box[1] - low_[1]) + std::size_t(size_[1]) * (box[2] - low_[2]));
}

std::uint32_t BoxGrid::cell(const Index3& box) const {
    for (int c = 0; c < 3; ++c)
        if (box[c] < low_[c] || box[c] >= low_[c] + size_[c]) return no_index;
    return first_[index(box)];
}

std::vector<char> BoxGrid::deep_cells(const Sampling& s, int reach) const {
    std::vector<char> near(first_.size());
    const std::vector<char> irregular = irregular_cells(s);
    for (std::size_t c = 0; c < irregular.size(); ++c)
        if (irregular[c]) near[index(s.cell_box[c])] = 1;
    for (int axis = 0; axis < 3; ++axis) dilate(near, size_, axis, reach);
    std::vector<char> deep(irregular.size());
    for (std::size_t c = 0; c < deep.size(); ++c) deep[c] = !near[index(s.cell_box[c])];
    return deep;
}

std::vector<std::uint32_t> sort_into_blocks(Sampling& s, int edge) {
    Index3 low = s.cell_box.front(), high = low, size{};
    for (const Index3& box : s.cell_box)
        for (int c = 0; c < 3; ++c) low[c] = std::min(low[c], box[c]), high[c] = std::max(high[c], box[c]);
    for (int c = 0; c < 3; ++c) {
        // Equal parts: a body a little longer than one block is one block, not a whole one and a rest.
        const int extent = high[c] - low[c] + 1, parts = std::max(1, (extent + edge / 2) / edge);
        size[c] = (extent + parts - 1) / parts;
    }
    std::vector<Index3> block(s.points.size());
    for (std::size_t q = 0; q < block.size(); ++q)
        for (int c = 0; c < 3; ++c) block[q][2 - c] = (s.cell_box[s.point_cell[q]][c] - low[c]) / size[c];
    std::vector<std::uint32_t> order(s.points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
        return block[a] != block[b] ? block[a] < block[b] : s.point_cell[a] < s.point_cell[b];
    });
    permute(s.points, order);
    permute(s.volumes, order);
    permute(s.point_cell, order);
    permute(s.point_node, order);
    permute(s.point_kind, order);
    permute(block, order);
    std::vector<std::uint32_t> begin;
    for (std::uint32_t q = 0; q < block.size(); ++q)
        if (q == 0 || block[q] != block[q - 1]) begin.push_back(q);
    begin.push_back(static_cast<std::uint32_t>(block.size()));
    return begin;
}

}  // namespace phyxel
