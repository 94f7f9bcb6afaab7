#pragma once

#include <span>

#include "base/threads.h"
#include "phyxel/vector.h"

/// Sums and products of nodal vector fields, the same for any number of threads.

namespace phyxel {

inline constexpr std::size_t node_chunk = 1024;

/// sum_i a_i . b_i
inline double inner(std::span<const Vec3> a, std::span<const Vec3> b, const Threads& threads) {
    return threads.sum(a.size(), node_chunk, [&](std::size_t i) { return dot(a[i], b[i]); });
}

/// y += s a
inline void add_scaled(std::span<Vec3> y, double s, std::span<const Vec3> a, const Threads& threads) {
    threads.for_each(y.size(), node_chunk, [&](std::size_t i) { y[i] += s * a[i]; });
}

/// Component by component.
inline Vec3 times(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// y := mask y, component by component.
inline void apply_mask(std::span<Vec3> y, std::span<const Vec3> mask, const Threads& threads) {
    threads.for_each(y.size(), node_chunk, [&](std::size_t i) { y[i] = times(mask[i], y[i]); });
}

}  // namespace phyxel
