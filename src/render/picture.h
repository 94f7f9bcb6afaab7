#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace phyxel {

/// Pixels as they go to a file or a screen: sRGB, rows from the top down.
struct Picture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  ///< [height * width * 3]

    std::size_t row_bytes() const { return static_cast<std::size_t>(width) * 3; }
    const std::uint8_t* pixel(int x, int y) const {
        return rgb.data() + static_cast<std::size_t>(y) * row_bytes() + static_cast<std::size_t>(x) * 3;
    }
};

}  // namespace phyxel
