#include "approximation/consistency_panel.h"

#include <algorithm>

#include "base/simd.h"

namespace phyxel {

namespace {

using Floats = float __attribute__((vector_size(32), aligned(4), may_alias));

/// y = A x for one group of rows, `values` [columns][16].
[[gnu::always_inline]] inline void multiply_group(const float* values, std::span<const Vec3f> x, float (&y)[3][16]) {
    Floats sum[3][2] = {};
    for (const Vec3f& v : x) {
        const Floats low = *reinterpret_cast<const Floats*>(values),
                     high = *reinterpret_cast<const Floats*>(values + 8);
        sum[0][0] += low * v.x, sum[0][1] += high * v.x;
        sum[1][0] += low * v.y, sum[1][1] += high * v.y;
        sum[2][0] += low * v.z, sum[2][1] += high * v.z;
        values += Panel::group;
    }
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t half = 0; half < 2; ++half) *reinterpret_cast<Floats*>(&y[c][8 * half]) = sum[c][half];
}

PHYXEL_AVX2 void multiply_group_avx2(const float* values, std::span<const Vec3f> x, float (&y)[3][16]) {
    multiply_group(values, x, y);
}
void multiply_group_anywhere(const float* values, std::span<const Vec3f> x, float (&y)[3][16]) {
    multiply_group(values, x, y);
}

}  // namespace

void Panel::multiply(std::span<const Vec3f> x, std::span<Vec3f> y) const {
    const auto kernel = has_avx2() ? multiply_group_avx2 : multiply_group_anywhere;
    float product[3][group];
    for (std::size_t first = 0; first < rows_; first += group) {
        kernel(&values_[first * columns_], x.first(columns_), product);
        for (std::size_t i = first; i < std::min(first + group, rows_); ++i)
            y[i] = {product[0][i - first], product[1][i - first], product[2][i - first]};
    }
}

}  // namespace phyxel
