#pragma once

#include <string>
#include <vector>

#include "render/canvas.h"
#include "render/render_scene.h"

namespace phyxel {

/// Where a number stands on a scale, and how it is written.
struct Tick {
    double place = 0;  ///< 0 at the lower end of the scale, 1 at the upper
    std::string label;
};

/// The ends of the scale and round numbers between them.
struct Ticks {
    std::vector<Tick> ticks;  ///< from the lower end to the upper
    std::string heading;      ///< title and unit: "von Mises stress [kPa]"
};
Ticks ticks_of(const ColorScale& scale);

/// The legend of a picture `picture_height` pixels high: heading, bar of colours, numbers beside it.
Canvas draw_legend(const ColorScale& scale, int picture_height);

}  // namespace phyxel
