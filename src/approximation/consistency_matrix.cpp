#include "approximation/consistency_matrix.h"

#include <algorithm>

namespace phyxel {

namespace {

/// For each block the points that see a node of it, ascending.
struct PointsOfBlocks {
    std::vector<std::size_t> offset;  // [blocks + 1]
    std::vector<std::uint32_t> point;
};

PointsOfBlocks points_of_blocks(const ConsistencyInput& input, const ConsistencyBlocks& blocks) {
    std::vector<std::uint32_t> block_of(blocks.size());
    for (std::uint32_t b = 0; b < blocks.blocks.size(); ++b)
        std::fill(block_of.begin() + blocks.blocks[b].begin, block_of.begin() + blocks.blocks[b].end, b);

    PointsOfBlocks result;
    result.offset.assign(blocks.blocks.size() + 1, 0);
    const auto for_each_incidence = [&](auto&& visit) {
        std::vector<std::uint32_t> last(blocks.blocks.size(), ConsistencyBlocks::none);
        for (std::uint32_t q = 0; q < input.points.size(); ++q)
            for (std::size_t pair = input.offset[q]; pair < input.offset[q + 1]; ++pair) {
                const std::uint32_t b = block_of[blocks.number[input.node[pair]]];
                if (last[b] == q) continue;
                last[b] = q;
                visit(b, q);
            }
    };
    for_each_incidence([&](std::uint32_t b, std::uint32_t) { ++result.offset[b + 1]; });
    for (std::size_t b = 0; b < blocks.blocks.size(); ++b) result.offset[b + 1] += result.offset[b];
    result.point.resize(result.offset.back());
    std::vector<std::size_t> next(result.offset.begin(), result.offset.end() - 1);
    for_each_incidence([&](std::uint32_t b, std::uint32_t q) { result.point[next[b]++] = q; });
    return result;
}

/// Scratch of one thread's share: the rows of a block as a dense matrix over the nodes that it meets.
class BlockRows {
public:
    explicit BlockRows(std::size_t zone_nodes) : local_(zone_nodes, ConsistencyBlocks::none) {}

    void start(const ConsistencyBlocks::Block& block, const ConsistencyInput& input, const ConsistencyBlocks& blocks,
               std::span<const std::uint32_t> points) {
        block_ = block;
        columns_.clear();
        for (const std::uint32_t q : points)
            for (std::size_t pair = input.offset[q]; pair < input.offset[q + 1]; ++pair) {
                const std::uint32_t j = blocks.number[input.node[pair]];
                if (local_[j] != ConsistencyBlocks::none) continue;
                local_[j] = 0;
                columns_.push_back(j);
            }
        std::sort(columns_.begin(), columns_.end());
        for (std::uint32_t k = 0; k < columns_.size(); ++k) local_[columns_[k]] = k;
        dense_.assign((block.end - block.begin) * columns_.size(), 0.0);
    }

    /// Adds V (W - (W v)(W v)^T) to the rows of the block.
    void add(const WeightedStencil& stencil, const LinearFit& fit, double volume,
             std::span<const std::uint32_t> number) {
        const std::size_t n = stencil.size();
        place_.resize(n);
        term_.resize(n);
        for (auto& f : function_) f.resize(n);
        for (std::size_t j = 0; j < n; ++j) {
            place_[j] = local_[number[stencil.node[j]]];
            for (std::size_t k = 0; k < 4; ++k) function_[k][j] = stencil.weight[j] * fit(k, stencil.position[j]);
        }
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t row = number[stencil.node[i]];
            if (row < block_.begin || row >= block_.end) continue;
            const double a0 = volume * function_[0][i], a1 = volume * function_[1][i];
            const double a2 = volume * function_[2][i], a3 = volume * function_[3][i];
            double* const out = &dense_[(row - block_.begin) * columns_.size()];
            for (std::size_t j = 0; j < n; ++j)
                term_[j] = a0 * function_[0][j] + a1 * function_[1][j] + a2 * function_[2][j] + a3 * function_[3][j];
            for (std::size_t j = 0; j < n; ++j) out[place_[j]] -= term_[j];
            out[place_[i]] += volume * stencil.weight[i];
        }
    }

    /// Hands each entry (row, column, value) that is not zero or on the diagonal to `visit`, in order.
    template <class Visit>
    void finish(Visit&& visit) {
        for (std::uint32_t row = block_.begin; row < block_.end; ++row)
            for (std::size_t k = 0; k < columns_.size(); ++k) {
                const double value = dense_[(row - block_.begin) * columns_.size() + k];
                if (value != 0 || columns_[k] == row) visit(row, columns_[k], value);
            }
        for (const std::uint32_t j : columns_) local_[j] = ConsistencyBlocks::none;
    }

private:
    ConsistencyBlocks::Block block_;
    std::vector<std::uint32_t> local_, columns_, place_;
    std::vector<double> dense_, term_;
    std::array<std::vector<double>, 4> function_;
};

struct Entries {
    std::vector<std::uint32_t> column;
    std::vector<double> value;
};

constexpr std::size_t blocks_a_chunk = 4, rows_a_chunk = 512;

}  // namespace

void ConsistencyMatrix::multiply(std::span<const Vec3> x, std::span<Vec3> y, const Threads& threads) const {
    threads.for_each(size(), rows_a_chunk, [&](std::size_t i) {
        Vec3 sum;
        for (std::size_t k = row[i]; k < row[i + 1]; ++k) sum += value[k] * x[column[k]];
        y[i] = sum;
    });
}

ConsistencyMatrix assemble(const ConsistencyInput& input, std::span<const LinearFit> fits,
                           const ConsistencyBlocks& blocks, const Threads& threads) {
    const PointsOfBlocks seen = points_of_blocks(input, blocks);
    ConsistencyMatrix S;
    S.row.assign(blocks.size() + 1, 0);
    S.diagonal.resize(blocks.size());

    // Each block's rows by themselves, some blocks at a time: rows of all blocks, to be joined in the end, would take
    // twice the memory. What is reserved beyond the need is never touched.
    constexpr std::size_t batch = 8 * blocks_a_chunk, most_entries_a_row = 512;
    S.column.reserve(std::min(blocks.size() * blocks.size(), blocks.size() * most_entries_a_row));
    S.value.reserve(S.column.capacity());
    for (std::size_t first = 0; first < blocks.blocks.size(); first += batch) {
        std::vector<Entries> entries(std::min(batch, blocks.blocks.size() - first));
        threads.for_chunks(entries.size(), blocks_a_chunk, [&](std::size_t begin, std::size_t end) {
            BlockRows rows(blocks.size());
            WeightedStencil stencil;
            for (std::size_t b = first + begin; b < first + end; ++b) {
                const auto points = std::span(seen.point).subspan(seen.offset[b], seen.offset[b + 1] - seen.offset[b]);
                rows.start(blocks.blocks[b], input, blocks, points);
                for (const std::uint32_t q : points) {
                    stencil.load(input, q);
                    rows.add(stencil, fits[q], input.volumes[q], blocks.number);
                }
                rows.finish([&](std::uint32_t i, std::uint32_t j, double value) {
                    entries[b - first].column.push_back(j);
                    entries[b - first].value.push_back(value);
                    ++S.row[i + 1];
                    if (i == j) S.diagonal[i] = value;
                });
            }
        });
        for (const Entries& block : entries) {
            S.column.insert(S.column.end(), block.column.begin(), block.column.end());
            S.value.insert(S.value.end(), block.value.begin(), block.value.end());
        }
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) S.row[i + 1] += S.row[i];
    return S;
}

}  // namespace phyxel
