#pragma once

#include <algorithm>

#include "phyxel/world.h"

/// Soft bodies that fall: what they are made of, and where they are.

namespace phyxel::studies {

inline const Material falling_material =
    corotated({.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.4});  // [kg/m^3], [Pa]

/// y of the lowest vertex of the surface [m].
inline double lowest(const World& world, BodyId body) {
    const auto surface = world.surface(body).positions();
    return std::min_element(surface.begin(), surface.end(), [](const Vec3f& a, const Vec3f& b) { return a.y < b.y; })
        ->y;
}

}  // namespace phyxel::studies
