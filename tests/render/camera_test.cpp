#include "render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

/// The largest |x| and |y| of the box's corners in the picture, 1 at its edge.
struct Extent {
    double x = 0, y = 0;
};
Extent extent(const Camera& camera, const Vec3& lower, const Vec3& upper, double aspect) {
    const Vec3 z = camera.backward(), x = normalized(cross(camera.up, z)), y = cross(z, x);
    Extent e;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{corner & 1 ? upper.x : lower.x, corner & 2 ? upper.y : lower.y, corner & 4 ? upper.z : lower.z};
        const double scale = 1 / (camera.tangent() * -dot(p - camera.eye, z));
        e.x = std::max(e.x, std::abs(dot(p - camera.eye, x) * scale) / aspect);
        e.y = std::max(e.y, std::abs(dot(p - camera.eye, y) * scale));
    }
    return e;
}

TEST(Camera, fitted_box_fills_the_picture_up_to_the_margin) {
    for (const Vec3& size : {Vec3{1, 1, 1}, Vec3{10, 0.1, 0.1}, Vec3{0.01, 5, 0.01}, Vec3{1e-3, 1e-3, 2e-3}})
        for (const Vec3& up : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 2, 3}})
            for (double aspect : {0.5, 1.0, 16.0 / 9}) {
                const Vec3 lower{3, -2, 1}, upper = lower + size;
                const Camera camera = fit_camera(lower, upper, aspect, up, {.margin = 1.25});
                const Extent e = extent(camera, lower, upper, aspect);
                EXPECT_NEAR(std::max(e.x, e.y), 1 / 1.25, 1e-6);
            }
}

TEST(Camera, looks_down_from_the_given_elevation) {
    const Camera camera = fit_camera({-1, 0, -1}, {1, 2, 1}, 1.5, {0, 1, 0}, {.azimuth = 0, .elevation = 30});
    EXPECT_NEAR(camera.backward().y, 0.5, 1e-12);
    EXPECT_NEAR(camera.backward().x, 0, 1e-12);
    EXPECT_GT(camera.backward().z, 0);
}

TEST(Camera, a_box_of_no_extent_is_still_seen) {
    const Camera camera = fit_camera({1, 1, 1}, {1, 1, 1}, 1.5);
    EXPECT_NEAR(camera.distance(), 1, 1e-12);
}

TEST(Camera, horizontal_frames_are_right_handed_and_orthonormal) {
    for (const Vec3& up : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -3}, Vec3{1, 0, 0}, Vec3{-1, 2, 5}}) {
        const HorizontalFrame f = horizontal_frame(up);
        EXPECT_NEAR(norm(f.front), 1, 1e-12);
        EXPECT_NEAR(dot(f.front, f.up), 0, 1e-12);
        EXPECT_NEAR(norm(cross(f.up, f.front) - f.side), 0, 1e-12);
    }
}

}  // namespace
}  // namespace phyxel
