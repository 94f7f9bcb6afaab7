#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "phyxel/phyxel.h"

namespace phyxel {

/// Gravity of a world that was told nothing else [m/s^2].
inline constexpr double g = 9.81;

/// 0.1 m along every edge.
inline const TriangleMesh cube_mesh = make_box({0.1, 0.1, 0.1});

/// A soft body that is cheap to step: 1e5 Pa, nodes 2.5 cm apart.
inline BodySettings small_body(BodySettings settings = {}) {
    settings.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
    if (settings.spacing == 0) settings.spacing = 0.025;
    return settings;
}

/// [m]
inline Vec3 center_of_mass(const World& world, BodyId body) { return world.report(body).center_of_mass; }

/// Momentum over mass [m/s].
inline Vec3 mean_velocity(const World& world, BodyId body) {
    Vec3 sum{};
    double mass = 0;
    for (std::size_t i = 0; i < world.masses(body).size(); ++i) {
        sum += world.masses(body)[i] * world.velocities(body)[i];
        mass += world.masses(body)[i];
    }
    return sum / mass;
}

/// Steps that must all be found.
inline void take_steps(World& world, int count) {
    for (int k = 0; k < count; ++k) {
        const StepReport report = world.step();
        ASSERT_EQ(report.status, StepStatus::ok) << report.message;
    }
}

/// Whether every node is somewhere and every speed a number.
inline bool all_finite(const World& world, BodyId body) {
    const auto finite = [](const auto& values) {
        return std::all_of(values.begin(), values.end(), [](const auto& v) { return is_finite(v); });
    };
    return finite(world.positions(body)) && finite(world.velocities(body)) && finite(world.surface(body).positions()) &&
           finite(world.surface(body).normals());
}

}  // namespace phyxel
