#include "forces/fast_forces.h"

#include <cmath>

namespace phyxel {
namespace {

constexpr std::size_t fast_chunk = 256;  ///< nodes

}  // namespace

FastForces::Rows::Rows(const SparseRows& rows) {
    for (std::size_t i = 0; i + 1 < rows.offset.size(); ++i) {
        for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
            column.push_back(rows.column[k]);
            value.push_back(static_cast<float>(rows.value[k]));
        }
        offset.push_back(static_cast<std::uint32_t>(column.size()));
    }
}

FastForces::FastForces(const Model& m, CellBlocks cells)
    : cells_(std::move(cells)), rows_(m.filter.rows), columns_(m.filter.columns) {
    for (double k : m.filter_stiffness) stiffness_.push_back(static_cast<float>(k));
    first_.resize(stiffness_.size());
    second_.resize(stiffness_.size());
}

Float4Lanes FastForces::product(const Rows& rows, std::size_t i, const std::vector<Float4>& in) {
    // In four sums: one would wait for the latency of its own additions.
    const auto term = [&](std::uint32_t k) {
        return rows.value[k] * reinterpret_cast<const Float4Lanes&>(in[rows.column[k]]);
    };
    Float4Lanes sum[4] = {};
    std::uint32_t k = rows.offset[i];
    const std::uint32_t end = rows.offset[i + 1];
    for (; k + 4 <= end; k += 4)
        for (std::uint32_t s = 0; s < 4; ++s) sum[s] += term(k + s);
    for (; k < end; ++k) sum[0] += term(k);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

void FastForces::filter(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    // Positions are large against what the filter keeps of them: the first pass is in double.
    const SparseRows& rows = m.filter.rows;
    threads.for_each(x.size(), fast_chunk, [&](std::size_t i) {
        Vec3 sum{};
        for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k)
            sum += rows.value[k] * (x[rows.column[k]] - x[i]);
        first_[i] = {{static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z), 0}};
    });
    filter_twice(threads);
}

void FastForces::filter_twice(const Threads& threads) {
    threads.for_each(first_.size(), fast_chunk,
                     [&](std::size_t i) { reinterpret_cast<Float4Lanes&>(second_[i]) = product(rows_, i, first_); });
}

template <class Add>
void FastForces::spread_filtered(const Threads& threads, Add&& add) {
    threads.for_each(first_.size(), fast_chunk,
                     [&](std::size_t i) { reinterpret_cast<Float4Lanes&>(second_[i]) *= stiffness_[i]; });
    threads.for_each(first_.size(), fast_chunk,
                     [&](std::size_t i) { reinterpret_cast<Float4Lanes&>(first_[i]) = product(columns_, i, second_); });
    threads.for_each(first_.size(), fast_chunk, [&](std::size_t i) {
        const Float4Lanes force = product(columns_, i, first_);
        add(i, Vec3f{force[0], force[1], force[2]});
    });
}

void FastForces::forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) {
    cells_.forces(m, x, threads, f);
    if (stiffness_.empty()) return;
    filter(m, x, threads);
    spread_filtered(threads, [&](std::size_t i, const Vec3f& force) { f[i] -= vector_cast<double>(force); });
}

double FastForces::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    double U = cells_.energy(m, x, threads);
    if (stiffness_.empty()) return U;
    filter(m, x, threads);
    return U + 0.5 * threads.sum(x.size(), fast_chunk, [&](std::size_t i) {
        const float* u = second_[i].lane;
        return static_cast<double>(stiffness_[i]) * static_cast<double>(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    });
}

void FastForces::rest_action(const Model& m, std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out) {
    cells_.rest_action(m, d, threads, out);
    if (stiffness_.empty()) return;
    threads.for_each(d.size(), fast_chunk, [&](std::size_t i) { second_[i] = {{d[i].x, d[i].y, d[i].z, 0}}; });
    threads.for_each(d.size(), fast_chunk,
                     [&](std::size_t i) { reinterpret_cast<Float4Lanes&>(first_[i]) = product(rows_, i, second_); });
    filter_twice(threads);
    spread_filtered(threads, [&](std::size_t i, const Vec3f& force) { out[i] += force; });
}

}  // namespace phyxel
