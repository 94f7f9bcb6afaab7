#pragma once

#include "forces/internal_forces.h"
#include "model/modelled.h"
#include "support/two_threads.h"

/// Forces and stiffness of a model against differences of its energy.

namespace phyxel {

inline double total_energy(const Model& m, std::span<const Vec3> x) {
    ForceWorkspace work;
    return elastic_energy(m, x, work, threads) + stabilization_energy(m, x, work, threads);
}

inline std::vector<Vec3> forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v = {},
                                double beta = 0) {
    ForceWorkspace work;
    std::vector<Vec3> f(x.size());
    internal_forces(m, x, v, beta, work, threads, f);
    return f;
}

inline std::vector<Vec3> stiffness_times(const Model& m, std::span<const Vec3> x, std::span<const Vec3> d) {
    ForceWorkspace work;
    std::vector<Vec3> out(x.size());
    stiffness_action(m, x, d, work, threads, out);
    return out;
}

inline std::vector<Vec3> moved(std::vector<Vec3> x, double s, std::span<const Vec3> d) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += s * d[i];
    return x;
}

/// Dense directions, and some that move one node along one axis.
inline std::vector<std::vector<Vec3>> directions(std::size_t nodes) {
    std::vector<std::vector<Vec3>> all;
    for (unsigned seed = 1; seed <= 3; ++seed) all.push_back(random_field(nodes, 1, seed));
    for (std::size_t k = 0; k < 12; ++k) {
        all.emplace_back(nodes);
        all.back()[k * nodes / 12][k % 3] = 1;
    }
    return all;
}

/// Largest error of the force along the directions by central differences of fourth order, over |f| |d|.
inline double force_error(const Model& m, std::span<const Vec3> x) {
    const std::vector<Vec3> f = forces(m, x), at(x.begin(), x.end());
    const double step = 1e-3 * m.node_length;
    double worst = 0;
    for (const auto& d : directions(x.size())) {
        const auto energy = [&](double s) { return total_energy(m, moved(at, s, d)); };
        const double near = energy(step) - energy(-step), far = energy(2 * step) - energy(-2 * step);
        const double slope = (8 * near - far) / (12 * step);
        worst = std::max(worst, std::abs(slope + inner(f, d)) / (std::sqrt(inner(f, f) * inner(d, d))));
    }
    return worst;
}

/// Largest error of the stiffness action against differences of the forces, over the largest of its entries.
inline double stiffness_error(const Model& m, std::span<const Vec3> x) {
    const std::vector<Vec3> at(x.begin(), x.end());
    const double step = 1e-3 * m.node_length;
    double worst = 0;
    for (const auto& d : directions(x.size())) {
        const auto f = [&](double s) { return forces(m, moved(at, s, d)); };
        const auto p1 = f(step), m1 = f(-step), p2 = f(2 * step), m2 = f(-2 * step), K = stiffness_times(m, x, d);
        std::vector<Vec3> slope(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) slope[i] = -(8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12 * step);
        worst = std::max(worst, largest_difference(slope, K) / largest(K));
    }
    return worst;
}

}  // namespace phyxel
