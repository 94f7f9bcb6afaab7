#include "render/canvas.h"

#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

/// Share of a pixel covered by a shape whose edge is at the signed `distance` from the pixel's centre.
double coverage(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

double distance_to(const Segment& s, double x, double y) {
    const double dx = s.x1 - s.x0, dy = s.y1 - s.y0, length_squared = dx * dx + dy * dy;
    const double along = (x - s.x0) * dx + (y - s.y0) * dy;
    const double t = length_squared > 0 ? std::clamp(along / length_squared, 0.0, 1.0) : 0;
    return std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy);
}

}  // namespace

void Canvas::blend(int x, int y, Color color, double share) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_ || share <= 0) return;
    Color& pixel =
        pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
    const float a = color.a * static_cast<float>(share), rest = 1 - a;
    pixel = {a * color.r + rest * pixel.r, a * color.g + rest * pixel.g, a * color.b + rest * pixel.b,
             a + rest * pixel.a};
}

void Canvas::rectangle(double left, double top, double right, double bottom, double radius, Color color) {
    const double half_width = (right - left) / 2 - radius, half_height = (bottom - top) / 2 - radius;
    for (int y = static_cast<int>(std::floor(top)) - 1; y <= static_cast<int>(bottom) + 1; ++y)
        for (int x = static_cast<int>(std::floor(left)) - 1; x <= static_cast<int>(right) + 1; ++x) {
            const double dx = std::abs(x + 0.5 - (left + right) / 2) - half_width;
            const double dy = std::abs(y + 0.5 - (top + bottom) / 2) - half_height;
            const double outside = std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
            blend(x, y, color, coverage(outside + std::min(std::max(dx, dy), 0.0) - radius));
        }
}

void Canvas::lines(std::span<const Segment> segments, double width, Color color) {
    if (segments.empty()) return;
    double left = width_, right = 0, top = height_, bottom = 0;
    for (const Segment& s : segments) {
        left = std::min({left, s.x0, s.x1}), right = std::max({right, s.x0, s.x1});
        top = std::min({top, s.y0, s.y1}), bottom = std::max({bottom, s.y0, s.y1});
    }
    const double reach = width / 2 + 1;
    for (int y = static_cast<int>(std::floor(top - reach)); y <= bottom + reach; ++y)
        for (int x = static_cast<int>(std::floor(left - reach)); x <= right + reach; ++x) {
            double nearest = reach;
            for (const Segment& s : segments) nearest = std::min(nearest, distance_to(s, x + 0.5, y + 0.5));
            blend(x, y, color, coverage(nearest - width / 2));
        }
}

}  // namespace phyxel
