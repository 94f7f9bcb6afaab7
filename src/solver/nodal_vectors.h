#pragma once

#include <vector>

#include "base/threads.h"
#include "phyxel/vector.h"

/// Sums and products of nodal vector fields, the same for any number of threads.

namespace phyxel {

inline constexpr std::size_t node_chunk = 1024;

/// sum_i a_i . b_i
template <class T>
double inner(const std::vector<Vec3T<T>>& a, const std::vector<Vec3T<T>>& b, const Threads& threads) {
    return threads.sum(a.size(), node_chunk, [&](std::size_t i) { return static_cast<double>(dot(a[i], b[i])); });
}

/// y += s a
template <class T>
void add_scaled(std::vector<Vec3T<T>>& y, T s, const std::vector<Vec3T<T>>& a, const Threads& threads) {
    threads.for_each(y.size(), node_chunk, [&](std::size_t i) { y[i] += s * a[i]; });
}

/// Component by component.
template <class T>
Vec3T<T> times(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}

}  // namespace phyxel
