#include "forces/float_filter.h"

#include "base/simd.h"

namespace phyxel {
namespace {

constexpr std::size_t filter_chunk = 256;

}  // namespace

FloatFilter::Rows::Rows(const SparseRows& rows) {
    for (std::size_t i = 0; i + 1 < rows.offset.size(); ++i) {
        for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
            column.push_back(rows.column[k]);
            value.push_back(static_cast<float>(rows.value[k]));
        }
        offset.push_back(static_cast<std::uint32_t>(column.size()));
    }
}

FloatFilter::FloatFilter(const Model& m) : rows_(m.filter.rows), columns_(m.filter.columns) {
    for (double k : m.filter_stiffness) stiffness_.push_back(static_cast<float>(k));
    first_.resize(stiffness_.size());
    second_.resize(stiffness_.size());
}

namespace {

Float4Lanes& float_lanes(Float4& v) { return reinterpret_cast<Float4Lanes&>(v); }
const Float4Lanes& float_lanes(const Float4& v) { return reinterpret_cast<const Float4Lanes&>(v); }

/// Rows begin to end of a sparse product. In four sums: one would wait for the latency of its own additions.
[[gnu::always_inline]] inline void multiply_rows(const std::uint32_t* offset, const std::uint32_t* column,
                                                 const float* value, std::size_t begin, std::size_t end,
                                                 const Float4* in, Float4* out) {
    for (std::size_t i = begin; i < end; ++i) {
        const auto term = [&](std::uint32_t k) { return value[k] * float_lanes(in[column[k]]); };
        Float4Lanes sum[4] = {};
        std::uint32_t k = offset[i];
        for (; k + 4 <= offset[i + 1]; k += 4)
            for (std::uint32_t s = 0; s < 4; ++s) sum[s] += term(k + s);
        for (; k < offset[i + 1]; ++k) sum[0] += term(k);
        float_lanes(out[i]) = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
}

/// Rows of a sparse product whose rows add up to nothing, with differences from the row's own place in double.
[[gnu::always_inline]] inline void multiply_differences(const SparseRows& rows, std::size_t begin, std::size_t end,
                                                        const Double4* x, Float4* out) {
    for (std::size_t i = begin; i < end; ++i) {
        const Lanes own = lanes(x[i]);
        Lanes sum[2] = {};
        std::uint32_t k = rows.offset[i];
        const auto term = [&](std::uint32_t at) { return rows.value[at] * (lanes(x[rows.column[at]]) - own); };
        for (; k + 2 <= rows.offset[i + 1]; k += 2) sum[0] += term(k), sum[1] += term(k + 1);
        if (k < rows.offset[i + 1]) sum[0] += term(k);
        const Lanes total = sum[0] + sum[1];
        for (int c = 0; c < 4; ++c) out[i].lane[c] = static_cast<float>(total[c]);
    }
}

using MultiplyRows = void (*)(const std::uint32_t*, const std::uint32_t*, const float*, std::size_t, std::size_t,
                              const Float4*, Float4*);
void multiply_rows_plain(const std::uint32_t* offset, const std::uint32_t* column, const float* value,
                         std::size_t begin, std::size_t end, const Float4* in, Float4* out) {
    multiply_rows(offset, column, value, begin, end, in, out);
}
PHYXEL_AVX2 void multiply_rows_avx2(const std::uint32_t* offset, const std::uint32_t* column, const float* value,
                                    std::size_t begin, std::size_t end, const Float4* in, Float4* out) {
    multiply_rows(offset, column, value, begin, end, in, out);
}
void multiply_differences_plain(const SparseRows& rows, std::size_t begin, std::size_t end, const Double4* x,
                                Float4* out) {
    multiply_differences(rows, begin, end, x, out);
}
PHYXEL_AVX2 void multiply_differences_avx2(const SparseRows& rows, std::size_t begin, std::size_t end, const Double4* x,
                                           Float4* out) {
    multiply_differences(rows, begin, end, x, out);
}

}  // namespace

void FloatFilter::multiply(const Rows& rows, const Field& in, const Threads& threads, Field& out) {
    const MultiplyRows product = has_avx2() ? multiply_rows_avx2 : multiply_rows_plain;
    threads.for_chunks(out.size(), filter_chunk, [&](std::size_t begin, std::size_t end) {
        product(rows.offset.data(), rows.column.data(), rows.value.data(), begin, end, in.data(), out.data());
    });
}

void FloatFilter::stiffen(Field& field, const Threads& threads) const {
    threads.for_each(field.size(), filter_chunk, [&](std::size_t i) { float_lanes(field[i]) *= stiffness_[i]; });
}

double FloatFilter::filter(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    // Positions are large against what the filter keeps of them: the first pass is in double.
    positions_.resize(x.size());
    threads.for_each(x.size(), filter_chunk, [&](std::size_t i) {
        lanes(positions_[i]) = Lanes{x[i].x, x[i].y, x[i].z, 0};
    });
    const auto differences = has_avx2() ? multiply_differences_avx2 : multiply_differences_plain;
    threads.for_chunks(x.size(), filter_chunk, [&](std::size_t begin, std::size_t end) {
        differences(m.filter.rows, begin, end, positions_.data(), first_.data());
    });
    multiply(rows_, first_, threads, second_);
    return 0.5 * threads.sum(x.size(), filter_chunk, [&](std::size_t i) {
        const float* u = second_[i].lane;
        return static_cast<double>(stiffness_[i]) * static_cast<double>(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    });
}

double FloatFilter::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    return empty() ? 0 : filter(m, x, threads);
}

double FloatFilter::add_forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) {
    if (empty()) return 0;
    const double energy = filter(m, x, threads);
    stiffen(second_, threads);
    multiply(columns_, second_, threads, first_);
    multiply(columns_, first_, threads, second_);
    threads.for_each(f.size(), filter_chunk, [&](std::size_t i) {
        const float* force = second_[i].lane;
        f[i] -= Vec3{double(force[0]), double(force[1]), double(force[2])};
    });
    return energy;
}

void FloatFilter::add_once_filtered(std::span<const Vec3f> d, float share, const Threads& threads,
                                    std::span<Vec3f> out) {
    if (empty()) return;
    threads.for_each(d.size(), filter_chunk, [&](std::size_t i) { second_[i] = {{d[i].x, d[i].y, d[i].z, 0}}; });
    multiply(rows_, second_, threads, first_);
    stiffen(first_, threads);
    multiply(columns_, first_, threads, second_);
    threads.for_each(out.size(), filter_chunk, [&](std::size_t i) {
        const float* force = second_[i].lane;
        out[i] += share * Vec3f{force[0], force[1], force[2]};
    });
}

}  // namespace phyxel
