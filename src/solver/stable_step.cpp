#include "solver/stable_step.h"

#include <cmath>

namespace phyxel {
namespace {

/// What twenty or more iterations miss of the largest frequency at most, measured on whole and clipped bodies.
constexpr double margin = 1.05;

/// Start vector without structure, the same for every run.
Vec3 scrambled(std::size_t i) {
    const auto component = [&](std::uint64_t salt) {
        std::uint64_t z =
            (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15u + salt * 0xbf58476d1ce4e5b9u;  // splitmix64
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
    };
    return {component(1), component(2), component(3)};
}

}  // namespace

double LargestFrequency::estimate(const Model& m, std::span<const Vec3> x, int iterations, ForceWorkspace& work,
                                  const Threads& threads) {
    constexpr std::size_t chunk = 1024;
    const std::size_t n = m.rest.size();
    if (mode_.size() != n) {
        mode_.resize(n);
        for (std::size_t i = 0; i < n; ++i) mode_[i] = scrambled(i);
    }
    image_.resize(n);
    double lambda = 0;
    for (int k = 0; k < iterations; ++k) {
        const double size =
            std::sqrt(threads.sum(n, chunk, [&](std::size_t i) { return m.mass[i] * norm_squared(mode_[i]); }));
        if (!(size > 0) || !std::isfinite(size)) return size;  // no stiffness at all, or no longer numbers
        threads.for_each(n, chunk, [&](std::size_t i) { mode_[i] /= size; });
        stiffness_action(m, x, mode_, work, threads, image_);
        // |M^-1 K d| in the metric of the masses: closer than the Rayleigh quotient, and right where K is indefinite.
        lambda = std::sqrt(
            threads.sum(n, chunk, [&](std::size_t i) { return m.inverse_mass[i] * norm_squared(image_[i]); }));
        threads.for_each(n, chunk, [&](std::size_t i) { mode_[i] = m.inverse_mass[i] * image_[i]; });
    }
    return margin * std::sqrt(lambda);
}

double stable_step(double omega, double stiffness_damping) {
    constexpr double share = 0.6;
    const double xi = 0.5 * stiffness_damping * omega;
    return share * (2 / omega) * (std::sqrt(1 + xi * xi) - xi);
}

}  // namespace phyxel
