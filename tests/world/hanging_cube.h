#pragma once

#include "world/motion.h"

namespace phyxel {

/// A cube that hangs by its upper face; without a Poisson's ratio it sags by rho g L^2 / (2 E).
struct HangingCube {
    static constexpr double L = 0.1, density = 1000;  ///< [m], [kg/m^3]

    HangingCube(double youngs_modulus, const WorldSettings& settings, double ratio = 0)
        : world(settings), expected_sag(density * g * L * L / (2 * youngs_modulus)) {
        const BodyId body = world.add_body(
            make_box({L, L, L}),
            {.spacing = L / 6,
             .material = corotated({.density = density, .youngs_modulus = youngs_modulus, .poissons_ratio = ratio})});
        world.add_fix(body, {.box = {{-1, L / 2, -1}, {1, 1, 1}}});
        foot = world.add_probe(body, {0, -L / 2, 0});
    }
    double sag() const { return world.probe(foot).rest.y - world.probe(foot).position.y; }

    World world;
    double expected_sag;  ///< [m] without a Poisson's ratio
    std::size_t foot;
};

}  // namespace phyxel
