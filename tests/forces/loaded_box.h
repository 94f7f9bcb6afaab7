#pragma once

#include "phyxel/body.h"
#include "phyxel/vector.h"

namespace phyxel {

/// The box that is held and loaded [m], and a selection of all of its surface.
inline constexpr Vec3 sides = {1, 0.8, 0.6};
inline constexpr BoxSelection everything = {{-10, -10, -10}, {10, 10, 10}};

}  // namespace phyxel
