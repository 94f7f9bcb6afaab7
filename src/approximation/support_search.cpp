#include "approximation/support_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "approximation/kernel.h"
#include "base/eigen3.h"

namespace phyxel {
namespace {

/// How far cells are walked, in support radii.
constexpr double walk = 1.25;
/// Half the diagonal of a box, and a little: how far points of a cell are from its centre, in pitches.
constexpr double half_diagonal = 0.9;

std::uint32_t nearest_node(const Sampling& sampling, const Vec3& position) {
    std::uint32_t best = 0;
    for (std::uint32_t n = 1; n < sampling.nodes.size(); ++n)
        if (norm_squared(sampling.nodes[n] - position) < norm_squared(sampling.nodes[best] - position)) best = n;
    return best;
}

template <class Word, class Visit>
void for_each_bit(const std::vector<Word>& words, Visit&& visit) {
    for (std::size_t w = 0; w < words.size(); ++w)
        for (Word rest = words[w]; rest; rest &= rest - 1)
            visit(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
}

template <class Word>
void set_bit(std::vector<Word>& words, std::size_t bit) {
    words[bit / 64] |= Word{1} << bit % 64;
}

}  // namespace

bool varies_more_than(double least, std::span<const Vec3> offsets, KernelShape kernel, double radius) {
    double total = 0;
    Vec3 mean{};
    Mat3 second;
    for (const Vec3& d : offsets) {
        const double w = weight(kernel, norm(d) / radius);
        total += w;
        mean += w * d;
        second += outer(w * d, d);
    }
    mean /= total;
    const Mat3 C = second * (1 / total) - outer(mean, mean);
    // The smallest eigenvalue is the determinant over the product of the others, which is at most (trace/2)^2.
    const double t = trace(C);
    if (4 * determinant(C) > 1.01 * least * t * t) return true;
    return symmetric_eigen(C).values.x > least;
}

SupportSearch::SupportSearch(const Sampling& sampling)
    : sampling_(sampling), local_(sampling.cell_box.size(), no_index), local_node_(sampling.nodes.size()) {}

void SupportSearch::look_around(std::uint32_t cell, double reach) {
    const Sampling& s = sampling_;
    around_.cell = cell;
    around_.reach = reach;

    // Cells, breadth first.
    std::vector<std::uint32_t>& cells = around_.cells;
    cells.assign(1, cell);
    local_[cell] = 0;
    for (std::size_t next = 0; next < cells.size(); ++next)
        for (std::uint32_t k = s.neighbor_offset[cells[next]]; k < s.neighbor_offset[cells[next] + 1]; ++k) {
            const std::uint32_t other = s.neighbors[k];
            if (local_[other] != no_index) continue;
            if (!(norm_squared(s.cell_centers[other] - s.cell_centers[cell]) < reach * reach)) continue;
            local_[other] = static_cast<std::uint32_t>(cells.size());
            cells.push_back(other);
        }

    // Their nodes.
    around_.nodes.clear();
    for (std::uint32_t c : cells)
        for (std::uint32_t n : s.cell_nodes[c])
            if (n != no_index) around_.nodes.push_back(n);
    std::sort(around_.nodes.begin(), around_.nodes.end());
    around_.nodes.erase(std::unique(around_.nodes.begin(), around_.nodes.end()), around_.nodes.end());
    around_.positions.clear();
    for (std::uint32_t n : around_.nodes) {
        local_node_[n] = static_cast<std::uint32_t>(around_.positions.size());
        around_.positions.push_back(s.nodes[n]);
    }

    // What holds and touches what.
    const std::size_t words = (cells.size() + 63) / 64;
    around_.centers.clear();
    around_.held.assign(cells.size(), {no_index, no_index});
    around_.touching.assign(cells.size() * words, 0);
    for (std::size_t l = 0; l < cells.size(); ++l) {
        const std::uint32_t c = cells[l];
        around_.centers.push_back(s.cell_centers[c]);
        for (std::size_t slot = 0; slot < 2; ++slot)
            if (const std::uint32_t n = s.cell_nodes[c][slot]; n != no_index) around_.held[l][slot] = local_node_[n];
        for (std::uint32_t k = s.neighbor_offset[c]; k < s.neighbor_offset[c + 1]; ++k)
            if (const std::uint32_t other = local_[s.neighbors[k]]; other != no_index)
                around_.touching[l * words + other / 64] |= Word{1} << other % 64;
    }
    for (std::uint32_t c : cells) local_[c] = no_index;
}

const std::vector<std::uint32_t>& SupportSearch::find(const Vec3& position, std::uint32_t cell, double radius) {
    const double aside = norm(position - sampling_.cell_centers[cell]);
    const double needed = walk * radius + aside;
    if (around_.cell != cell || around_.reach < needed)
        look_around(cell, std::max(needed * (1 + 1e-9), walk * radius + half_diagonal * sampling_.pitch));

    // Cells within the walk.
    const double walk_squared = walk * walk * radius * radius, radius_squared = radius * radius * (1 - 1e-9);
    const std::size_t words = (around_.cells.size() + 63) / 64;
    near_.assign(words, 0);
    for (std::size_t l = 0; l < around_.cells.size(); ++l)
        near_[l / 64] |= Word{norm_squared(around_.centers[l] - position) < walk_squared} << l % 64;

    // Those of them that are joined to the first, wave by wave, and the nodes that they hold.
    held_.assign((around_.nodes.size() + 63) / 64, 0);
    reached_.assign(words, 0);
    frontier_.assign(words, 0);
    frontier_[0] = reached_[0] = 1;
    for (bool grows = true; grows;) {
        next_.assign(words, 0);
        for_each_bit(frontier_, [&](std::size_t l) {
            for (std::uint32_t n : around_.held[l])
                if (n != no_index) set_bit(held_, n);
            for (std::size_t w = 0; w < words; ++w) next_[w] |= around_.touching[l * words + w];
        });
        grows = false;
        for (std::size_t w = 0; w < words; ++w) {
            next_[w] &= near_[w] & ~reached_[w];
            reached_[w] |= next_[w];
            grows = grows || next_[w] != 0;
        }
        frontier_.swap(next_);
    }

    found_.clear();
    for_each_bit(held_, [&](std::size_t n) {
        if (norm_squared(around_.positions[n] - position) < radius_squared) found_.push_back(around_.nodes[n]);
    });
    return found_;
}

void find_support(SupportSearch& search, const Sampling& sampling, KernelShape kernel, double radius,
                  const Vec3& position, std::uint32_t cell, Support& out) {
    constexpr std::size_t fewest = 8;
    constexpr int widenings = 12;
    out.radius = radius;
    for (int attempt = 0;; ++attempt) {
        out.nodes = search.find(position, cell, out.radius);
        out.offsets.clear();
        for (std::uint32_t n : out.nodes) out.offsets.push_back(sampling.nodes[n] - position);
        out.widened = attempt > 0;
        if (attempt == widenings) break;
        if (out.nodes.size() >= fewest &&
            varies_more_than(1e-2 * sampling.pitch * sampling.pitch, out.offsets, kernel, out.radius))
            break;
        out.radius *= 1.12;
    }
    if (!out.nodes.empty()) return;
    out.nodes = {nearest_node(sampling, position)};
    out.offsets = {sampling.nodes[out.nodes[0]] - position};
    out.radius = 2 * norm(out.offsets[0]) + sampling.pitch;
}

}  // namespace phyxel
