#pragma once

#include <string_view>

#include "render/canvas.h"

namespace phyxel {

/// Writing in lines of even width with round ends, at any size, without a font file. Printable ASCII; any other byte is
/// left out. `height` is that of a capital letter [pixels].

/// Width of a line of text [pixels].
double text_width(std::string_view text, double height);

/// Writes with the left end of the base line at (x, y), y downwards.
void draw_text(Canvas& canvas, double x, double y, double height, std::string_view text, Color color);

}  // namespace phyxel
