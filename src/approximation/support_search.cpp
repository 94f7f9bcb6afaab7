#include "approximation/support_search.h"

#include <algorithm>

#include "approximation/kernel.h"
#include "base/eigen3.h"

namespace phyxel {
namespace {

/// Smallest variance of node positions under the kernel's weights [m^2].
double smallest_variance(std::span<const Vec3> offsets, KernelShape kernel, double radius) {
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
    return symmetric_eigen(second * (1 / total) - outer(mean, mean)).values.x;
}

std::uint32_t nearest_node(const Sampling& sampling, const Vec3& position) {
    std::uint32_t best = 0;
    for (std::uint32_t n = 1; n < sampling.nodes.size(); ++n)
        if (norm_squared(sampling.nodes[n] - position) < norm_squared(sampling.nodes[best] - position)) best = n;
    return best;
}

}  // namespace

SupportSearch::SupportSearch(const Sampling& sampling)
    : sampling_(sampling), seen_cell_(sampling.cell_box.size()), seen_node_(sampling.nodes.size()) {}

const std::vector<std::uint32_t>& SupportSearch::find(const Vec3& position, std::uint32_t cell, double radius) {
    ++search_;
    const double reach_squared = 1.25 * 1.25 * radius * radius, radius_squared = radius * radius * (1 - 1e-9);
    nodes_.clear();
    queue_.assign(1, cell);
    seen_cell_[cell] = search_;
    for (std::size_t next = 0; next < queue_.size(); ++next) {
        const std::uint32_t c = queue_[next];
        for (std::uint32_t n : sampling_.cell_nodes[c]) {
            if (n == no_index || seen_node_[n] == search_) continue;
            seen_node_[n] = search_;
            if (norm_squared(sampling_.nodes[n] - position) < radius_squared) nodes_.push_back(n);
        }
        for (std::uint32_t k = sampling_.neighbor_offset[c]; k < sampling_.neighbor_offset[c + 1]; ++k) {
            const std::uint32_t other = sampling_.neighbors[k];
            if (seen_cell_[other] == search_) continue;
            seen_cell_[other] = search_;
            if (norm_squared(sampling_.cell_centers[other] - position) < reach_squared) queue_.push_back(other);
        }
    }
    std::sort(nodes_.begin(), nodes_.end());
    return nodes_;
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
            smallest_variance(out.offsets, kernel, out.radius) > 1e-2 * sampling.pitch * sampling.pitch)
            break;
        out.radius *= 1.12;
    }
    if (!out.nodes.empty()) return;
    out.nodes = {nearest_node(sampling, position)};
    out.offsets = {sampling.nodes[out.nodes[0]] - position};
    out.radius = 2 * norm(out.offsets[0]) + sampling.pitch;
}

}  // namespace phyxel
