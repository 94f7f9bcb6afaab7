#pragma once

#include <cmath>

#include "bench/benches.h"
#include "geometry/mesh_check.h"
#include "model/model.h"
#include "phyxel/mesh.h"

/// The beam of 0.1 x 0.1 x 1 m that kernels and solvers are measured on.

namespace phyxel::bench {

/// Spacings [m]: 496, 1,025, 1,836, 4,544, 9,100 and 31,725 nodes.
inline constexpr double beam_spacings[] = {0.1 / 3, 0.1 / 4, 0.1 / 5, 0.1 / 7, 0.1 / 9, 0.1 / 14};

inline Model beam_model(double spacing, const Threads& threads) {
    BodySettings settings;
    settings.spacing = spacing;
    settings.material = corotated({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3});
    StencilReport report;
    return build_model(sample(check_and_repair(make_box({0.1, 0.1, 1})), settings, spacing, threads), settings, threads,
                       report);
}

/// The beam bent by `radians` and twisted a little.
inline std::vector<Vec3> bent(const Model& model, double radians) {
    std::vector<Vec3> x;
    for (const Vec3& X : model.rest) {
        const double angle = radians * X.z, radius = 1 / radians + X.x;
        x.push_back({radius * std::cos(angle), X.y + 0.1 * X.x * X.z, radius * std::sin(angle)});
    }
    return x;
}

/// Shortest time [s] of a call, of as many as fit the time of a measurement.
template <class Work>
double shortest_call(Work&& work) {
    constexpr double seconds_a_measurement = 0.3;
    const double once = std::max(1e-6, shortest(3, work));
    return shortest(std::max(5, static_cast<int>(seconds_a_measurement / once)), work);
}

}  // namespace phyxel::bench
