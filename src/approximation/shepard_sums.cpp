#include "approximation/shepard_sums.h"

namespace phyxel {

std::vector<double> shepard_sums(const Sampling& s, const ApproximationSettings& settings, const Stencils& st,
                                 std::span<const double> value, const Threads& threads) {
    // Block by block into slots, then the slots of each node in order.
    std::vector<double> slots(st.slot_node.size());
    threads.for_each(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        std::vector<double> share;
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
            const double radius = settings.support * static_cast<double>(st.support[q]);
            const std::uint16_t* local = &st.local[st.offset[q]];
            share.resize(st.offset[q + 1] - st.offset[q]);
            double total = 0;
            for (std::size_t k = 0; k < share.size(); ++k) {
                const Vec3& node = s.nodes[st.slot_node[block.slot_begin + local[k]]];
                total += share[k] = weight(settings.kernel, norm(node - s.points[q]) / radius);
            }
            for (std::size_t k = 0; k < share.size(); ++k)
                slots[block.slot_begin + local[k]] += share[k] / total * value[q];
        }
    });
    std::vector<double> sums(s.nodes.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        for (std::uint32_t k = st.node_slot_offset[i]; k < st.node_slot_offset[i + 1]; ++k)
            sums[i] += slots[st.node_slots[k]];
    return sums;
}

}  // namespace phyxel
