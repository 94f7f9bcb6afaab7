#include "approximation/embedded_points.h"

#include "approximation/moving_least_squares.h"
#include "approximation/support_search.h"
#include "base/scratch_pool.h"

namespace phyxel {

EmbeddedPoints embed(const Sampling& sampling, const ApproximationSettings& settings, std::span<const Vec3> positions,
                     std::span<const std::uint32_t> cells, Gradients gradients, const Threads& threads) {
    constexpr std::size_t chunk = 256;
    ScratchPool<SupportSearch> searches([&] { return std::make_unique<SupportSearch>(sampling); });
    std::vector<EmbeddedPoints> parts((positions.size() + chunk - 1) / chunk);
    threads.for_chunks(positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        EmbeddedPoints& part = parts[begin / chunk];
        Support support;
        ShapeFunctions shape;
        searches.with([&](SupportSearch& search) {
            for (std::size_t p = begin; p < end; ++p) {
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
    EmbeddedPoints all;
    all.offset.reserve(positions.size() + 1);
    for (EmbeddedPoints& part : parts) {
        const std::uint32_t base = all.offset.back();
        for (std::size_t p = 1; p < part.offset.size(); ++p) all.offset.push_back(base + part.offset[p]);
        all.node.insert(all.node.end(), part.node.begin(), part.node.end());
        all.phi.insert(all.phi.end(), part.phi.begin(), part.phi.end());
        all.gradient.insert(all.gradient.end(), part.gradient.begin(), part.gradient.end());
        part = {};
    }
    return all;
}

}  // namespace phyxel
