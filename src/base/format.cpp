#include "base/format.h"

#include <fmt/format.h>

namespace phyxel {

std::string format_number(double value) { return fmt::format("{:.6g}", value); }

std::string format_point(const Vec3& point) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", point.x, point.y, point.z);
}

}  // namespace phyxel
