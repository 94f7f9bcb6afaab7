#pragma once

#include "phyxel/phyxel.h"

namespace phyxel {

/// The beam of Brunet et al. 2019: 20 x 20 x 200 mm, one end clamped, a dead load on the other.
struct Beam {
    Beam(double spacing, const Vec3& force, const BodySettings& changes = {}, WorldSettings world_settings = {})
        : world(statics(world_settings)) {
        BodySettings settings = changes;
        settings.translation = {0.01, 0.01, 0.1};
        settings.spacing = spacing;
        settings.material = corotated({.density = 1000, .youngs_modulus = 50e6, .poissons_ratio = 0.45});
        body = world.add_body(make_box({0.02, 0.02, 0.2}), settings);
        grip = world.add_fix(body, {.box = {{-1, -1, -1}, {1, 1, 1e-6}}});
        world.add_load(body, {.box = {{-1, -1, 0.2 - 1e-6}, {1, 1, 1}}, .force = force});
        tip = world.add_probe(body, {0.01, 0.01, 0.2});
    }
    static WorldSettings statics(WorldSettings settings) {
        settings.time_step = 1;
        settings.gravity = {};
        settings.integrator = Integrator::statics;
        return settings;
    }
    /// Of the centre of the end face [m].
    Vec3 displacement() const { return world.probe(tip).position - world.probe(tip).rest; }

    World world;
    BodyId body;
    std::size_t grip, tip;
};

/// Loads [N], and where they take the centre of the end face: triquadratic hexahedra, extrapolated, and checked against
/// CalculiX [m].
inline constexpr Vec3 bending{0, -12, 0}, stretching{0, 0, 1500};
inline constexpr double bent = -45.162e-3, stretched = 14.8789e-3;

}  // namespace phyxel
