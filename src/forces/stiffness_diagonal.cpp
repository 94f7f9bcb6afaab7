#include "forces/stiffness_diagonal.h"

namespace phyxel {
namespace {

constexpr std::size_t diagonal_chunk = 256;  ///< nodes

/// V [lambda g g^T + mu (g g^T + |g|^2 I)] of all points, block by block.
void add_elastic(const Model& m, std::vector<Mat3>& diagonal, const Threads& threads) {
    const Stencils& st = m.stencils;
    std::vector<Mat3> slots(st.slot_node.size());
    threads.for_each(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
            const auto& [lambda, mu] = m.point_material(q).lame;
            const Vec3* g = &st.gradient[st.gradient_begin[q]] - st.offset[q];
            for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k)
                slots[block.slot_begin + st.local[k]] +=
                    m.volumes[q] * ((lambda + mu) * outer(g[k], g[k]) + mu * norm_squared(g[k]) * Mat3::identity());
        }
    });
    threads.for_each(diagonal.size(), diagonal_chunk, [&](std::size_t i) {
        for (std::uint32_t k = st.node_slot_offset[i]; k < st.node_slot_offset[i + 1]; ++k)
            diagonal[i] += slots[st.node_slots[k]];
    });
}

/// Squared columns of (I - Phi)^2, weighted by the stiffness of the filter.
void add_filter(const Model& m, std::vector<Mat3>& diagonal, const Threads& threads) {
    const SparseRows& columns = m.filter.columns;
    threads.for_chunks(diagonal.size(), diagonal_chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<double> column(diagonal.size());
        std::vector<std::uint32_t> touched;
        for (std::size_t i = begin; i < end; ++i) {
            for (std::uint32_t k = columns.offset[i]; k < columns.offset[i + 1]; ++k) {
                const std::uint32_t j = columns.column[k];
                for (std::uint32_t l = columns.offset[j]; l < columns.offset[j + 1]; ++l) {
                    column[columns.column[l]] += columns.value[k] * columns.value[l];
                    touched.push_back(columns.column[l]);
                }
            }
            double sum = 0;
            for (std::uint32_t j : touched) {
                sum += m.filter_stiffness[j] * column[j] * column[j];
                column[j] = 0;
            }
            touched.clear();
            diagonal[i] += sum * Mat3::identity();
        }
    });
}

void add_nodal(const Model& m, std::vector<Mat3>& diagonal) {
    const Stencils& st = m.stencils;
    for (const Stencils::Block& block : st.blocks)
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
            if (!(m.nodal.kappa[q] > 0)) continue;
            double sum = 0;
            for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k) {
                const double stiffness = m.nodal.kappa[q] * m.nodal.weight[k];
                diagonal[st.slot_node[block.slot_begin + st.local[k]]] += stiffness * Mat3::identity();
                sum += stiffness;
            }
            diagonal[m.sampling.point_node[q]] += sum * Mat3::identity();
        }
}

}  // namespace

std::vector<Mat3> stiffness_diagonal(const Model& m, const Threads& threads) {
    std::vector<Mat3> diagonal(m.rest.size());
    add_elastic(m, diagonal, threads);
    if (!m.filter_stiffness.empty()) add_filter(m, diagonal, threads);
    if (!m.nodal.kappa.empty()) add_nodal(m, diagonal);
    return diagonal;
}

}  // namespace phyxel
