#pragma once

#include <array>

#include "phyxel/vector.h"

namespace phyxel {

/// The perceptually uniform colour map "viridis" (S. van der Walt and N. Smith, matplotlib 1.5, 2015; public domain,
/// CC0): equal steps of the value are equal steps of perceived colour, also in grey and to colour-blind eyes.
/// `t` from 0 to 1, clamped; a value that is no number is grey. Returns sRGB, 0 to 1.
Vec3f color_map(double t);

}  // namespace phyxel
