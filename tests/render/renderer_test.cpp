#include "render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "phyxel/error.h"
#include "render/unit_shapes.h"

namespace phyxel {
namespace {

constexpr int width = 320, height = 240;

/// A red sphere of radius 1 that stands on a floor, seen from the front and a little above.
struct SphereOnFloor {
    ShapeMesh sphere = unit_sphere();
    std::vector<float> field;
    RenderScene scene;

    explicit SphereOnFloor(double lift = 0) {
        for (Vec3f& x : sphere.positions) {
            x.y += 1 + static_cast<float>(lift);
            field.push_back(x.y);
        }
        scene.meshes = {{sphere.positions, sphere.normals, sphere.triangles, {0.9f, 0.1f, 0.1f}, {}}};
        scene.planes = {Plane{}};
        scene.camera = fit_camera({-1, 0, -1}, {1, 2, 1}, double(width) / height, {0, 1, 0},
                                  {.azimuth = 0, .elevation = 20, .margin = 1.6});
    }
};

int brightness(const Picture& p, int x, int y) { return p.pixel(x, y)[0] + p.pixel(x, y)[1] + p.pixel(x, y)[2]; }
bool is_red(const Picture& p, int x, int y) { return p.pixel(x, y)[0] > p.pixel(x, y)[1] + 40; }

/// Where a point of the world is in the picture.
struct Pixel {
    int x, y;
};
Pixel pixel_of(const Camera& camera, const Vec3& point) {
    const Vec3 z = camera.backward(), x = normalized(cross(camera.up, z)), y = cross(z, x), d = point - camera.eye;
    const double scale = height / 2.0 / (camera.tangent() * -dot(d, z));
    return {static_cast<int>(width / 2.0 + scale * dot(d, x)), static_cast<int>(height / 2.0 - scale * dot(d, y))};
}

TEST(Renderer, object_is_in_the_middle_and_corners_are_not) {
    SphereOnFloor s;
    const Picture picture = Renderer(width, height).draw(s.scene);
    ASSERT_EQ(picture.width, width);
    ASSERT_EQ(picture.height, height);
    ASSERT_EQ(picture.rgb.size(), std::size_t(width) * height * 3);
    const Pixel center = pixel_of(s.scene.camera, {0, 1, 0});
    EXPECT_TRUE(is_red(picture, center.x, center.y));
    for (int x : {2, width - 3})
        for (int y : {2, height - 3}) EXPECT_FALSE(is_red(picture, x, y)) << x << ", " << y;

    // A sphere covers pi r^2: radius 1 at a known distance.
    int red = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) red += is_red(picture, x, y);
    const double distance = norm(s.scene.camera.eye - Vec3{0, 1, 0});
    const double radius = height / 2.0 / s.scene.camera.tangent() / std::sqrt(distance * distance - 1);
    EXPECT_NEAR(red / (M_PI * radius * radius), 1, 0.05);
}

TEST(Renderer, floor_is_darker_in_the_shadow_and_under_the_object) {
    SphereOnFloor standing, lifted(0.6);
    Renderer renderer(width, height);
    RenderScene bare = standing.scene;
    bare.meshes.clear();
    const Picture with = renderer.draw(standing.scene), up = renderer.draw(lifted.scene), without = renderer.draw(bare);

    // The key light comes from the left and the front: the shadow falls to the right, behind.
    const Pixel shadow = pixel_of(standing.scene.camera, {1.25, 0, -0.3}),
                lit = pixel_of(standing.scene.camera, {-1.9, 0, 1});
    EXPECT_LT(brightness(with, shadow.x, shadow.y), 0.85 * brightness(without, shadow.x, shadow.y));
    EXPECT_NEAR(brightness(with, lit.x, lit.y), brightness(without, lit.x, lit.y), 12);

    // Beside the point of contact, where the light still comes, the floor does not see the sky.
    const Pixel contact = pixel_of(standing.scene.camera, {-0.25, 0, 0.75});
    EXPECT_LT(brightness(with, contact.x, contact.y), brightness(up, contact.x, contact.y) - 10);
}

TEST(Renderer, legend_is_there_with_a_scale_only) {
    SphereOnFloor s;
    Renderer renderer(width, height);
    const Picture plain = renderer.draw(s.scene);
    s.scene.scale = ColorScale{0, 2, "height", "m"};
    const Picture with = renderer.draw(s.scene);
    int left = 0, right = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (!std::equal(plain.pixel(x, y), plain.pixel(x, y) + 3, with.pixel(x, y)))
                ++(x < width / 2 ? left : right);
    EXPECT_EQ(left, 0);
    EXPECT_GT(right, 1000);
}

TEST(Renderer, field_colours_the_surface_from_violet_to_yellow) {
    SphereOnFloor s;
    s.scene.meshes[0].field = s.field;
    s.scene.scale = ColorScale{0, 2, "height", "m"};
    const Picture picture = Renderer(width, height).draw(s.scene);
    const Pixel low = pixel_of(s.scene.camera, {0, 0.25, 0.66}), high = pixel_of(s.scene.camera, {0, 1.9, 0.43});
    EXPECT_GT(picture.pixel(low.x, low.y)[2], picture.pixel(low.x, low.y)[1]);      // violet: blue above green
    EXPECT_LT(picture.pixel(high.x, high.y)[2], picture.pixel(high.x, high.y)[1]);  // yellow: green above blue
    EXPECT_GT(picture.pixel(high.x, high.y)[0], picture.pixel(low.x, low.y)[0]);
}

TEST(Renderer, surfaces_without_normals_and_inside_out_are_lit) {
    SphereOnFloor s;
    Renderer renderer(width, height);
    const Pixel center = pixel_of(s.scene.camera, {0, 1, 0});
    const int smooth = brightness(renderer.draw(s.scene), center.x, center.y);
    s.scene.meshes[0].normals = {};
    EXPECT_NEAR(brightness(renderer.draw(s.scene), center.x, center.y), smooth, 30);
    for (Triangle& t : s.sphere.triangles) std::swap(t[0], t[1]);
    EXPECT_NEAR(brightness(renderer.draw(s.scene), center.x, center.y), smooth, 30);
}

TEST(Renderer, spheres_and_boxes_are_where_they_should_be) {
    SphereOnFloor s;
    Renderer renderer(width, height);
    s.scene.meshes.clear();
    const Picture bare = renderer.draw(s.scene);
    s.scene.spheres = {Sphere{{-1.2, 0.4, 0}, 0.4}};
    s.scene.boxes = {Box{{1.2, 0.4, 0}, {0.8, 0.8, 0.8}, {}}};
    const Picture picture = renderer.draw(s.scene);
    for (double x : {-1.2, 1.2}) {
        const Pixel p = pixel_of(s.scene.camera, {x, 0.4, 0});
        EXPECT_LT(brightness(picture, p.x, p.y), brightness(bare, p.x, p.y) - 60) << x;
    }
}

TEST(Renderer, the_same_scene_gives_the_same_bytes) {
    SphereOnFloor s;
    Renderer first(width, height);
    const Picture a = first.draw(s.scene);
    EXPECT_EQ(first.draw(s.scene).rgb, a.rgb);
    EXPECT_EQ(Renderer(width, height).draw(s.scene).rgb, a.rgb);
}

TEST(Renderer, many_renderers_follow_and_stand_beside_each_other) {
    SphereOnFloor s;
    std::optional<Renderer> first(std::in_place, 64, 48), second(std::in_place, 100, 30);
    EXPECT_EQ(second->draw(s.scene).width, 100);
    EXPECT_EQ(first->draw(s.scene).width, 64);
    first.reset();
    EXPECT_EQ(second->draw(s.scene).height, 30);
    second.reset();
    for (int i = 0; i < 2; ++i) EXPECT_EQ(Renderer(32 + i, 32).draw(s.scene).width, 32 + i);
}

TEST(Renderer, an_empty_scene_is_a_backdrop) {
    const Picture picture = Renderer(64, 48).draw({});
    EXPECT_GT(brightness(picture, 32, 24), 300);
}

TEST(Renderer, sizes_that_no_picture_can_have_are_refused) {
    EXPECT_THROW(Renderer(0, 100), Error);
    EXPECT_THROW(Renderer(100, -1), Error);
    EXPECT_THROW(Renderer(100000, 100), Error);
}

}  // namespace
}  // namespace phyxel
