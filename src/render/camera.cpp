#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace phyxel {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Along one axis of the picture, the eye must keep x - e_x between -t (e_z - z) and t (e_z - z) for every corner,
/// where t is the tangent of half the angle of view: the smallest e_z, and the e_x in the middle of what that leaves.
struct AxisFit {
    double tangent;
    double largest = -std::numeric_limits<double>::infinity();
    double smallest = std::numeric_limits<double>::infinity();

    void add(double x, double z) {
        largest = std::max(largest, x + tangent * z);
        smallest = std::min(smallest, x - tangent * z);
    }
    double eye() const { return (largest + smallest) / 2; }
    double distance() const { return (largest - smallest) / (2 * tangent); }
};

}  // namespace

double Camera::tangent() const { return std::tan(radians(field_of_view) / 2); }

HorizontalFrame horizontal_frame(const Vec3& up) {
    const Vec3 y = normalized(up);
    const Vec3 hint = std::abs(y.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{0, -1, 0};
    const Vec3 front = normalized(hint - dot(hint, y) * y);
    return {front, cross(y, front), y};
}

Vec3 direction_at(const HorizontalFrame& frame, double azimuth, double elevation) {
    const double a = radians(azimuth), e = radians(elevation);
    return std::cos(e) * (std::cos(a) * frame.front + std::sin(a) * frame.side) + std::sin(e) * frame.up;
}

Camera fit_camera(const Vec3& lower, const Vec3& upper, double aspect, const Vec3& up, const ViewDirection& direction) {
    Camera camera;
    camera.up = normalized(up);
    const Vec3 z = direction_at(horizontal_frame(up), direction.azimuth, direction.elevation);
    const Vec3 x = normalized(cross(camera.up, z)), y = cross(z, x);

    // The corners, seen from the middle of the box.
    const Vec3 middle = 0.5 * (lower + upper);
    const double tangent = camera.tangent() / direction.margin;
    AxisFit horizontal{tangent * aspect}, vertical{tangent};
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p =
            Vec3{corner & 1 ? upper.x : lower.x, corner & 2 ? upper.y : lower.y, corner & 4 ? upper.z : lower.z} -
            middle;
        horizontal.add(dot(p, x), dot(p, z));
        vertical.add(dot(p, y), dot(p, z));
    }

    // The nearer of the two bounds would cut the other axis.
    const double distance = std::max(horizontal.distance(), vertical.distance());
    camera.target = middle + horizontal.eye() * x + vertical.eye() * y;
    camera.eye = camera.target + (distance > 0 ? distance : 1) * z;
    return camera;
}

}  // namespace phyxel
