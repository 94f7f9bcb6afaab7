#include "approximation/consistency_blocks.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace phyxel {

namespace {

using Block = ConsistencyBlocks::Block;

/// Disjoint sets of nodes; each is named by its lowest member.
class Components {
public:
    explicit Components(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t i, std::uint32_t j) {
        i = find(i), j = find(j);
        parent_[std::max(i, j)] = std::min(i, j);
    }

private:
    std::vector<std::uint32_t> parent_;
};

/// A node on its way into a block.
struct Item {
    std::uint32_t component, node;
    Vec3 position;
};

/// Halves the longest side until no more than `block_size` are left; the halves stay consecutive.
void bisect(std::span<Item> items, std::uint32_t begin, std::size_t block_size, std::vector<Block>& blocks) {
    Vec3 low = items[0].position, high = low;
    for (const Item& item : items)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], item.position[k]);
            high[k] = std::max(high[k], item.position[k]);
        }
    if (items.size() <= block_size) {
        std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.node < b.node; });
        blocks.push_back({begin, begin + static_cast<std::uint32_t>(items.size())});
        return;
    }
    const Vec3 side = high - low;
    const std::size_t axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const std::size_t half = items.size() / 2;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                     [axis](const Item& a, const Item& b) {
                         return std::tie(a.position[axis], a.node) < std::tie(b.position[axis], b.node);
                     });
    bisect(items.first(half), begin, block_size, blocks);
    bisect(items.subspan(half), begin + static_cast<std::uint32_t>(half), block_size, blocks);
}

}  // namespace

ConsistencyBlocks cut_into_blocks(const ConsistencyInput& input, std::size_t block_size) {
    ConsistencyBlocks result;

    // nodes that are seen, and which hang together
    Components components(input.nodes.size());
    std::vector<char> seen(input.nodes.size(), 0);
    for (std::size_t q = 0; q + 1 < input.offset.size(); ++q)
        for (std::size_t pair = input.offset[q]; pair < input.offset[q + 1]; ++pair) {
            seen[input.node[pair]] = 1;
            components.join(input.node[input.offset[q]], input.node[pair]);
        }
    std::vector<Item> items;
    for (std::uint32_t i = 0; i < input.nodes.size(); ++i)
        if (seen[i]) items.push_back({components.find(i), i, input.nodes[i]});
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return std::tie(a.component, a.node) < std::tie(b.component, b.node);
    });

    // blocks, one connected part after the other
    for (std::size_t begin = 0, end = 0; begin < items.size(); begin = end) {
        while (end < items.size() && items[end].component == items[begin].component) ++end;
        result.component_begin.push_back(static_cast<std::uint32_t>(begin));
        bisect(std::span(items).subspan(begin, end - begin), static_cast<std::uint32_t>(begin), block_size,
               result.blocks);
    }
    result.component_begin.push_back(static_cast<std::uint32_t>(items.size()));

    // the new numbers
    result.number.assign(input.nodes.size(), ConsistencyBlocks::none);
    for (const Item& item : items) {
        result.number[item.node] = static_cast<std::uint32_t>(result.node.size());
        result.node.push_back(item.node);
        result.position.push_back(item.position);
    }

    // the linear functions on each block
    for (const Block& block : result.blocks) {
        const std::vector<double> ones(block.end - block.begin, 1.0);
        result.linear.push_back(fit_linear(std::span(result.position).subspan(block.begin, ones.size()), ones));
    }
    return result;
}

}  // namespace phyxel
