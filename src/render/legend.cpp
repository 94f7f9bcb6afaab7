#include "render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/color_map.h"
#include "render/stroke_font.h"

namespace phyxel {
namespace {

/// Numbers are written in units of 10^exponent.
struct Prefix {
    int exponent;
    const char* symbol;
};
constexpr Prefix prefixes[] = {{9, "G"}, {6, "M"}, {3, "k"}, {0, ""}, {-3, "m"}, {-6, "u"}, {-9, "n"}};

/// The prefix that leaves one to three digits before the point of `size`.
Prefix prefix_for(double size) {
    for (const Prefix& p : prefixes)
        if (size >= 0.9995 * std::pow(10.0, p.exponent)) return p;
    return {0, ""};
}

std::string heading(const ColorScale& scale, const Prefix& prefix) {
    if (scale.unit.empty() && prefix.exponent == 0) return scale.title;
    // A prefix goes before a unit, unless the unit has one or is a power ("km^2" is not 1000 m^2).
    const bool takes_prefix = !scale.unit.empty() && scale.unit[0] != 'k' && scale.unit.find('^') == std::string::npos;
    if (prefix.exponent == 0 || takes_prefix) return fmt::format("{} [{}{}]", scale.title, prefix.symbol, scale.unit);
    return fmt::format("{} [1e{} {}]", scale.title, prefix.exponent, scale.unit.empty() ? "-" : scale.unit);
}

/// The largest of 1, 2 and 5 times a power of ten of which at least four go into `range`.
double round_step(double range) {
    const double power = std::pow(10.0, std::floor(std::log10(range / 4)));
    const double ratio = range / 4 / power;
    return power * (ratio >= 5 ? 5 : ratio >= 2 ? 2 : 1);
}

/// Zero is written without a sign or a rounding error.
std::string number(double value, double range) {
    return fmt::format("{:.3g}", std::abs(value) < 1e-9 * range ? 0.0 : value);
}

}  // namespace

Ticks ticks_of(const ColorScale& scale) {
    const Prefix prefix = prefix_for(std::max(std::abs(scale.lower), std::abs(scale.upper)));
    const double unit = std::pow(10.0, prefix.exponent);
    const double lower = scale.lower / unit, upper = scale.upper / unit, range = upper - lower;
    Ticks result{{{0, number(lower, range)}}, heading(scale, prefix)};
    if (!(range > 0) || !std::isfinite(range)) return result;

    // Round numbers keep clear of the ends.
    const double step = round_step(range), clear = 0.07;
    for (double i = std::ceil(lower / step); i * step < upper; ++i) {
        const double place = (i * step - lower) / range;
        if (place > clear && place < 1 - clear) result.ticks.push_back({place, number(i * step, range)});
    }
    result.ticks.push_back({1, number(upper, range)});
    return result;
}

Canvas draw_legend(const ColorScale& scale, int picture_height) {
    const Ticks ticks = ticks_of(scale);
    const double text = std::max(7.0, picture_height / 60.0), margin = 1.6 * text;
    const double bar_width = 1.5 * text, bar_height = 0.46 * picture_height, bar_top = margin + 2.6 * text;
    double labels = 0;
    for (const Tick& tick : ticks.ticks) labels = std::max(labels, text_width(tick.label, text));
    const double inside = std::max(text_width(ticks.heading, text), bar_width + 1.4 * text + labels);
    Canvas canvas(static_cast<int>(std::ceil(inside + 2 * margin)),
                  static_cast<int>(std::ceil(bar_top + bar_height + margin)));
    const Color ink{0.17f, 0.20f, 0.25f, 1}, paper{1, 1, 1, 0.5f};

    // Panel and heading.
    canvas.rectangle(0, 0, canvas.width(), canvas.height(), 0.9 * text, paper);
    draw_text(canvas, margin, margin + text, text, ticks.heading, ink);

    // Bar, one row of pixels after the other.
    const int first = static_cast<int>(bar_top), rows = static_cast<int>(bar_height);
    for (int row = 0; row < rows; ++row) {
        const Vec3f c = color_map(1 - (row + 0.5) / rows);
        canvas.rectangle(margin, first + row, margin + bar_width, first + row + 1, 0, {c.x, c.y, c.z, 1});
    }

    // Ticks and numbers.
    for (const Tick& tick : ticks.ticks) {
        const double y = first + (1 - tick.place) * rows, x = margin + bar_width;
        const Segment mark[] = {{x + 0.2 * text, y, x + 0.7 * text, y}};
        canvas.lines(mark, 0.12 * text, ink);
        draw_text(canvas, x + 1.4 * text, y + text / 2, text, tick.label, ink);
    }
    return canvas;
}

}  // namespace phyxel
