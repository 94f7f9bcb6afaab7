#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace phyxel {

/// sRGB and opacity, 0 to 1.
struct Color {
    float r = 0, g = 0, b = 0, a = 1;
};

/// A straight line between two points.
struct Segment {
    double x0, y0, x1, y1;
};

/// A small picture with opacity, drawn on by the processor: what is laid over the scene. Coordinates are in pixels from
/// the upper left corner, y downwards; edges are smoothed by the share of the pixel they cover.
class Canvas {
public:
    Canvas(int width, int height)
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Color{0, 0, 0, 0}) {}

    int width() const { return width_; }
    int height() const { return height_; }
    /// [height * width], row by row from the top; colour is multiplied by opacity.
    const std::vector<Color>& pixels() const { return pixels_; }

    /// Lays `color` over a pixel as far as `share` (0 to 1) says; outside the canvas nothing happens.
    void blend(int x, int y, Color color, double share);
    /// A rectangle with corners of the given radius.
    void rectangle(double left, double top, double right, double bottom, double radius, Color color);
    /// Lines with round ends, drawn as one shape: where they cross or meet, nothing is laid on twice.
    void lines(std::span<const Segment> segments, double width, Color color);

private:
    int width_, height_;
    std::vector<Color> pixels_;
};

}  // namespace phyxel
