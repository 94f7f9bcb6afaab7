#include "forces/filter_action.h"

namespace phyxel {
namespace {

constexpr std::size_t node_chunk = 512;

Float4Lanes& lanes(Float4& v) { return reinterpret_cast<Float4Lanes&>(v); }
const Float4Lanes& lanes(const Float4& v) { return reinterpret_cast<const Float4Lanes&>(v); }

}  // namespace

FilterAction::FilterAction(const Model& model)
    : rows_(rows_of(model.filter.rows)), columns_(rows_of(model.filter.columns)) {
    set_materials(model);
    a_.resize(stiffness_.size());
    b_.resize(stiffness_.size());
}

void FilterAction::set_materials(const Model& model) {
    stiffness_.clear();
    for (const double k : model.filter_stiffness) stiffness_.push_back(static_cast<float>(k));
}

FilterAction::Rows FilterAction::rows_of(const SparseRows& rows) {
    Rows result{rows.offset, rows.column, {}};
    for (const double value : rows.value) result.value.push_back(static_cast<float>(value));
    return result;
}

Float4Lanes FilterAction::product(const Rows& rows, std::size_t i, const std::vector<Float4>& in) {
    // In four sums: one would wait for the latency of its own additions.
    Float4Lanes sum[4] = {};
    std::uint32_t k = rows.offset[i];
    const std::uint32_t end = rows.offset[i + 1];
    for (; k + 4 <= end; k += 4)
        for (std::uint32_t s = 0; s < 4; ++s) sum[s] += rows.value[k + s] * lanes(in[rows.column[k + s]]);
    for (; k < end; ++k) sum[0] += rows.value[k] * lanes(in[rows.column[k]]);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

void FilterAction::add(std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out) const {
    if (stiffness_.empty()) return;
    // Relative to the first node: the rows sum to zero but for rounding.
    threads.for_each(d.size(), node_chunk, [&](std::size_t i) {
        const Vec3f v = d[i] - d[0];
        a_[i] = {{v.x, v.y, v.z, 0}};
    });
    threads.for_each(d.size(), node_chunk, [&](std::size_t i) { lanes(b_[i]) = product(rows_, i, a_); });
    threads.for_each(d.size(), node_chunk,
                     [&](std::size_t i) { lanes(a_[i]) = stiffness_[i] * product(rows_, i, b_); });
    threads.for_each(d.size(), node_chunk, [&](std::size_t i) { lanes(b_[i]) = product(columns_, i, a_); });
    threads.for_each(d.size(), node_chunk, [&](std::size_t i) {
        const Float4Lanes v = product(columns_, i, b_);
        out[i] += Vec3f{v[0], v[1], v[2]};
    });
}

}  // namespace phyxel
