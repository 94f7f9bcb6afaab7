#include "approximation/embedded_points.h"

#include <algorithm>
#include <numeric>

#include "approximation/moving_least_squares.h"
#include "approximation/support_search.h"
#include "base/scratch_pool.h"

namespace phyxel {

EmbeddedPoints embed(const Sampling& sampling, const ApproximationSettings& settings, std::span<const Vec3> positions,
                     std::span<const std::uint32_t> cells, Gradients gradients, const Threads& threads) {
    // Cell by cell, so that searches share their surroundings.
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    if (!std::is_sorted(cells.begin(), cells.end()))
        std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cells[a] < cells[b]; });

    constexpr std::size_t chunk = 256;
    ScratchPool<SupportSearch> searches([&] { return std::make_unique<SupportSearch>(sampling); });
    std::vector<EmbeddedPoints> parts((positions.size() + chunk - 1) / chunk);
    threads.for_chunks(positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        EmbeddedPoints& part = parts[begin / chunk];
        Support support;
        ShapeFunctions shape;
        searches.with([&](SupportSearch& search) {
            for (std::size_t k = begin; k < end; ++k) {
                const std::uint32_t p = order[k];
                find_support(search, sampling, settings.kernel, settings.support, positions[p], cells[p], support);
                MovingLeastSquares mls(settings.kernel, support.radius);
                if (gradients == Gradients::yes) {
                    mls.values_and_gradients(support.offsets, shape);
                    for (const Vec3& g : shape.gradient) part.gradient.push_back(sampling.frame.direction_to_rest(g));
                } else {
                    mls.values(support.offsets, shape);
                }
                part.node.insert(part.node.end(), support.nodes.begin(), support.nodes.end());
                part.phi.insert(part.phi.end(), shape.phi.begin(), shape.phi.end());
                part.offset.push_back(static_cast<std::uint32_t>(part.node.size()));
            }
        });
    });

    // Back into the order of the points.
    EmbeddedPoints all;
    all.offset.assign(positions.size() + 1, 0);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const EmbeddedPoints& part = parts[k / chunk];
        all.offset[order[k] + 1] = part.offset[k % chunk + 1] - part.offset[k % chunk];
    }
    std::partial_sum(all.offset.begin(), all.offset.end(), all.offset.begin());
    all.node.resize(all.offset.back());
    all.phi.resize(all.offset.back());
    if (gradients == Gradients::yes) all.gradient.resize(all.offset.back());
    for (std::size_t k = 0; k < order.size(); ++k) {
        EmbeddedPoints& part = parts[k / chunk];
        const std::uint32_t from = part.offset[k % chunk], count = part.offset[k % chunk + 1] - from;
        const std::uint32_t to = all.offset[order[k]];
        std::copy_n(part.node.begin() + from, count, all.node.begin() + to);
        std::copy_n(part.phi.begin() + from, count, all.phi.begin() + to);
        if (gradients == Gradients::yes) std::copy_n(part.gradient.begin() + from, count, all.gradient.begin() + to);
        if ((k + 1) % chunk == 0) part = {};
    }
    return all;
}

}  // namespace phyxel
