#include "approximation/consistency_matrix.h"

#include <algorithm>
#include <array>

#include "base/scratch_pool.h"

namespace phyxel {

namespace {

/// Blocks whose rows are summed side by side, so that what is computed for a point serves all of them.
constexpr std::size_t blocks_a_group = 8;
constexpr std::size_t block_rows_a_chunk = 4;

/// row_j -= sum_k a_k f_k(j), entry j of a row being `place[j]` behind its first. (A version for AVX2 was slower: the
/// compiler then gathers.)
void subtract(const float (&a)[4], const std::array<std::vector<float>, 4>& f, std::span<const std::uint32_t> place,
              float* term, float* row) {
    const float *f0 = f[0].data(), *f1 = f[1].data(), *f2 = f[2].data(), *f3 = f[3].data();
    const std::size_t n = place.size();
    for (std::size_t j = 0; j < n; ++j) term[j] = a[0] * f0[j] + a[1] * f1[j] + a[2] * f2[j] + a[3] * f3[j];
    for (std::size_t j = 0; j < n; ++j) row[place[j]] -= term[j];
}
/// For each group of blocks the points that see a node of it, ascending.
struct PointsOfGroups {
    std::vector<std::size_t> offset;  // [groups + 1]
    std::vector<std::uint32_t> point;
};

PointsOfGroups points_of_groups(const ConsistencyInput& input, const ConsistencyBlocks& blocks,
                                std::span<const std::uint32_t> block_of, std::size_t groups) {
    PointsOfGroups result;
    result.offset.assign(groups + 1, 0);
    const auto for_each_incidence = [&](auto&& visit) {
        std::vector<std::uint32_t> last(groups, ConsistencyBlocks::none);
        for (std::uint32_t q = 0; q < input.points.size(); ++q)
            for (std::size_t pair = input.offset[q]; pair < input.offset[q + 1]; ++pair) {
                const std::size_t g = block_of[blocks.number[input.node[pair]]] / blocks_a_group;
                if (last[g] == q) continue;
                last[g] = q;
                visit(g, q);
            }
    };
    for_each_incidence([&](std::size_t g, std::uint32_t) { ++result.offset[g + 1]; });
    for (std::size_t g = 0; g < groups; ++g) result.offset[g + 1] += result.offset[g];
    result.point.resize(result.offset.back());
    std::vector<std::size_t> next(result.offset.begin(), result.offset.end() - 1);
    for_each_incidence([&](std::size_t g, std::uint32_t q) { result.point[next[g]++] = q; });
    return result;
}

/// Sums up the rows of a group of blocks. One object a thread.
class GroupAssembly {
public:
    GroupAssembly(const ConsistencyInput& input, std::span<const LinearFit> fits, const ConsistencyBlocks& blocks,
                  std::span<const std::uint32_t> block_of)
        : input_(input), fits_(fits), blocks_(blocks), block_of_(block_of) {
        for (auto& local : local_) local.assign(blocks.size(), ConsistencyBlocks::none);
    }

    /// Rows [first, last) of S, from the points that see them.
    void run(std::size_t first, std::size_t last, std::span<const std::uint32_t> points, ConsistencyMatrix& S) {
        first_ = first;
        last_ = last;
        find_columns(points, S);
        for (const std::uint32_t q : points) add_point(q, S);
        for (std::size_t b = first; b < last; ++b)
            for (const std::uint32_t j : S.rows[b].column) local_[b - first][j] = ConsistencyBlocks::none;
    }

private:
    /// Calls `visit(b)` once for each block of the group that holds a node of point q; fills in the nodes' new numbers.
    template <class Visit>
    void visit_blocks(std::uint32_t q, Visit&& visit) {
        number_.clear();
        unsigned met = 0;
        for (std::size_t pair = input_.offset[q]; pair < input_.offset[q + 1]; ++pair) {
            number_.push_back(blocks_.number[input_.node[pair]]);
            const std::size_t b = block_of_[number_.back()] - first_;
            if (b < last_ - first_) met |= 1u << b;
        }
        for (std::size_t b = 0; b < last_ - first_; ++b)
            if (met >> b & 1) visit(b);
    }

    /// Who meets whom.
    void find_columns(std::span<const std::uint32_t> points, ConsistencyMatrix& S) {
        for (const std::uint32_t q : points)
            visit_blocks(q, [&](std::size_t b) {
                for (const std::uint32_t j : number_) {
                    if (local_[b][j] != ConsistencyBlocks::none) continue;
                    local_[b][j] = 0;
                    S.rows[first_ + b].column.push_back(j);
                }
            });
        for (std::size_t b = first_; b < last_; ++b) {
            ConsistencyMatrix::Rows& rows = S.rows[b];
            const ConsistencyBlocks::Block& block = blocks_.blocks[b];
            std::sort(rows.column.begin(), rows.column.end());
            for (std::uint32_t k = 0; k < rows.column.size(); ++k) local_[b - first_][rows.column[k]] = k;
            rows.own = local_[b - first_][block.begin];
            rows.value = Panel(block.end - block.begin, rows.column.size());
        }
    }

    /// Adds V (W - (W v)(W v)^T) to the rows of the group.
    void add_point(std::uint32_t q, ConsistencyMatrix& S) {
        stencil_.load(input_, q);
        stencil_.evaluate(fits_[q]);
        const std::size_t n = stencil_.size();
        term_.resize(n);
        for (auto& f : function_) f.resize(n);
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t k = 0; k < 4; ++k)
                function_[k][j] = static_cast<float>(stencil_.weight[j] * stencil_.linear[j].lane[k]);
        const auto volume = static_cast<float>(input_.volumes[q]);
        visit_blocks(q, [&](std::size_t b) {
            place_.clear();
            for (const std::uint32_t j : number_)
                place_.push_back(static_cast<std::uint32_t>(Panel::group) * local_[b][j]);
            for (std::size_t i = 0; i < n; ++i) {
                if (block_of_[number_[i]] != first_ + b) continue;
                float* const row = S.rows[first_ + b].value.row(number_[i] - blocks_.blocks[first_ + b].begin);
                const float a[4] = {volume * function_[0][i], volume * function_[1][i], volume * function_[2][i],
                                    volume * function_[3][i]};
                subtract(a, function_, place_, term_.data(), row);
                row[place_[i]] += volume * static_cast<float>(stencil_.weight[i]);
            }
        });
    }

    const ConsistencyInput& input_;
    std::span<const LinearFit> fits_;
    const ConsistencyBlocks& blocks_;
    std::span<const std::uint32_t> block_of_;
    std::size_t first_ = 0, last_ = 0;
    std::array<std::vector<std::uint32_t>, blocks_a_group> local_;  // [zone nodes] column of a node, or `none`
    WeightedStencil stencil_;
    std::vector<std::uint32_t> number_, place_;
    std::array<std::vector<float>, 4> function_;
    std::vector<float> term_;
};

}  // namespace

void ConsistencyMatrix::multiply(const ConsistencyBlocks& blocks, std::span<const Vec3> x, std::span<Vec3> y,
                                 const Threads& threads) const {
    threads.for_chunks(rows.size(), block_rows_a_chunk, [&](std::size_t chunk_begin, std::size_t chunk_end) {
        std::vector<Vec3f> rest, product;
        for (std::size_t b = chunk_begin; b < chunk_end; ++b) {
            const auto [begin, end] = blocks.blocks[b];
            // the linear function that fits x on the block: value + slope (x) X
            Vec3 value;
            std::array<Vec3, 3> slope{};
            const LinearFit& fit = blocks.linear[b];
            for (std::size_t k = 0; k < 4; ++k) {
                Vec3 moment;
                for (std::uint32_t i = begin; i < end; ++i) moment += fit(k, blocks.position[i]) * x[i];
                value += fit.value[k] * moment;
                for (std::size_t c = 0; c < 3; ++c) slope[c] += fit.slope[k][c] * moment;
            }
            rest.clear();
            for (const std::uint32_t j : rows[b].column) {
                const Vec3& X = blocks.position[j];
                rest.push_back(vector_cast<float>(x[j] - (value + X.x * slope[0] + X.y * slope[1] + X.z * slope[2])));
            }
            product.resize(end - begin);
            rows[b].value.multiply(rest, product);
            for (std::uint32_t i = begin; i < end; ++i) y[i] = vector_cast<double>(product[i - begin]);
        }
    });
}

ConsistencyMatrix assemble(const ConsistencyInput& input, std::span<const LinearFit> fits,
                           const ConsistencyBlocks& blocks, const Threads& threads) {
    const std::size_t count = blocks.blocks.size(), groups = (count + blocks_a_group - 1) / blocks_a_group;
    std::vector<std::uint32_t> block_of(blocks.size());
    for (std::uint32_t b = 0; b < count; ++b)
        std::fill(block_of.begin() + blocks.blocks[b].begin, block_of.begin() + blocks.blocks[b].end, b);
    const PointsOfGroups seen = points_of_groups(input, blocks, block_of, groups);

    ConsistencyMatrix S;
    S.rows.resize(count);
    S.diagonal.resize(blocks.size());
    ScratchPool<GroupAssembly> scratch(
        [&] { return std::make_unique<GroupAssembly>(input, fits, blocks, std::span(block_of)); });
    threads.for_each(groups, 1, [&](std::size_t g) {
        const std::size_t first = g * blocks_a_group, last = std::min(first + blocks_a_group, count);
        const auto points = std::span(seen.point).subspan(seen.offset[g], seen.offset[g + 1] - seen.offset[g]);
        scratch.with([&](GroupAssembly& assembly) { assembly.run(first, last, points, S); });
        for (std::size_t b = first; b < last; ++b)
            for (std::uint32_t i = blocks.blocks[b].begin, k = 0; i < blocks.blocks[b].end; ++i, ++k)
                S.diagonal[i] = static_cast<double>(S.rows[b].value.at(k, S.rows[b].own + k));
    });
    return S;
}

}  // namespace phyxel
