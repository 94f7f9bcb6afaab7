#pragma once

#include <string>

#include "phyxel/vector.h"

/// Numbers and places in messages.

namespace phyxel {

/// "0.005", "1.2e-07": six significant digits.
std::string format_number(double value);

/// "[0.1, 0.2, 0.3]".
std::string format_point(const Vec3& point);

}  // namespace phyxel
