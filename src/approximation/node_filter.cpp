#include "approximation/node_filter.h"

#include "approximation/embedded_points.h"

namespace phyxel {

SparseRows transposed(const SparseRows& rows, std::size_t columns) {
    SparseRows t;
    t.offset.assign(columns + 1, 0);
    t.column.resize(rows.column.size());
    t.value.resize(rows.value.size());
    for (std::uint32_t c : rows.column) ++t.offset[c + 1];
    for (std::size_t c = 0; c < columns; ++c) t.offset[c + 1] += t.offset[c];
    std::vector<std::uint32_t> next(t.offset.begin(), t.offset.end() - 1);
    for (std::uint32_t r = 0; r + 1 < rows.offset.size(); ++r)
        for (std::uint32_t k = rows.offset[r]; k < rows.offset[r + 1]; ++k) {
            const std::uint32_t at = next[rows.column[k]]++;
            t.column[at] = r;
            t.value[at] = rows.value[k];
        }
    return t;
}

NodeFilter build_filter(const Sampling& sampling, const ApproximationSettings& settings, const Threads& threads) {
    EmbeddedPoints shapes = embed(sampling, settings, sampling.nodes, sampling.node_cell, Gradients::no, threads);
    NodeFilter filter;
    for (std::uint32_t i = 0; i < sampling.nodes.size(); ++i)
        for (std::uint32_t k = shapes.offset[i]; k < shapes.offset[i + 1]; ++k)
            shapes.phi[k] = (shapes.node[k] == i ? 1.0 : 0.0) - shapes.phi[k];
    filter.rows = {std::move(shapes.offset), std::move(shapes.node), std::move(shapes.phi)};
    filter.columns = transposed(filter.rows, sampling.nodes.size());
    return filter;
}

}  // namespace phyxel
