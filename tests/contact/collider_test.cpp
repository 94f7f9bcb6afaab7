#include "contact/collider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "phyxel/error.h"

namespace phyxel {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Vec3 random_point(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-3, 3);
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    return {x, y, z};
}

TEST(PlaneCollider, has_the_distance_of_a_half_space) {
    const Collider plane(Plane{.point = {1, 2, 3}, .normal = {0, 0, 5}});
    EXPECT_DOUBLE_EQ(plane.distance({7, -8, 4.5}).value, 1.5);
    EXPECT_DOUBLE_EQ(plane.distance({7, -8, 2}).value, -1);
    EXPECT_EQ(plane.distance({0, 0, 0}).normal, (Vec3{0, 0, 1}));
}

TEST(SphereCollider, has_the_distance_to_its_centre_less_its_radius) {
    const Collider sphere(Sphere{.center = {1, 0, 0}, .radius = 2});
    EXPECT_DOUBLE_EQ(sphere.distance({1, 3, 4}).value, 3);
    EXPECT_DOUBLE_EQ(sphere.distance({1, 0.5, 0}).value, -1.5);
    EXPECT_EQ(sphere.distance({1, 0, -7}).normal, (Vec3{0, 0, -1}));
    const Distance at_centre = sphere.distance({1, 0, 0});
    EXPECT_DOUBLE_EQ(at_centre.value, -2);
    EXPECT_DOUBLE_EQ(norm(at_centre.normal), 1);
}

TEST(BoxCollider, has_the_distance_to_faces_edges_and_corners) {
    const Collider box(Box{.center = {1, 1, 1}, .size = {2, 4, 6}});
    EXPECT_DOUBLE_EQ(box.distance({3, 1, 1}).value, 1);              // face
    EXPECT_DOUBLE_EQ(box.distance({2 + 3, 3 + 4, 1}).value, 5);      // edge
    EXPECT_DOUBLE_EQ(box.distance({2 + 2, 3 + 3, 4 + 6}).value, 7);  // corner
    EXPECT_DOUBLE_EQ(box.distance({1.75, 1, 1}).value, -0.25);       // inside, nearest face
    EXPECT_EQ(box.distance({0.25, 1, 1}).normal, (Vec3{-1, 0, 0}));
    EXPECT_EQ(box.distance({1, 1, 9}).normal, (Vec3{0, 0, 1}));
}

TEST(BoxCollider, turns_with_its_rotation) {
    const AxisAngle turn{{1, 2, 3}, 50};
    const Mat3 R = rotation_about(normalized(turn.axis), turn.degrees * std::numbers::pi / 180);
    const Collider straight(Box{.size = {2, 4, 6}}), turned(Box{.size = {2, 4, 6}, .rotation = turn});
    std::mt19937 random(1);
    for (int k = 0; k < 200; ++k) {
        const Vec3 p = random_point(random);
        const Distance a = straight.distance(p), b = turned.distance(R * p);
        EXPECT_NEAR(a.value, b.value, 1e-14);
        EXPECT_NEAR(norm(R * a.normal - b.normal), 0, 1e-12);
    }
}

TEST(Colliders, have_normals_that_are_the_gradient_of_the_distance) {
    const Collider all[] = {Collider(Plane{.normal = {1, 2, -1}}), Collider(Sphere{.radius = 1.5}),
                            Collider(Box{.size = {2, 3, 1}, .rotation = {{0, 1, 1}, 33}})};
    std::mt19937 random(2);
    for (const Collider& collider : all)
        for (int k = 0; k < 100; ++k) {
            const Vec3 p = random_point(random);
            const double h = 1e-6;
            Vec3 gradient;
            for (int c = 0; c < 3; ++c) {
                Vec3 step{};
                step[c] = h;
                gradient[c] = (collider.distance(p + step).value - collider.distance(p - step).value) / (2 * h);
            }
            EXPECT_NEAR(norm(gradient - collider.distance(p).normal), 0, 1e-6);
        }
}

TEST(Colliders, are_no_nearer_to_a_box_of_space_than_to_any_point_in_it) {
    const Collider all[] = {Collider(Plane{.normal = {1, 2, -1}}), Collider(Sphere{.radius = 1.5}),
                            Collider(Box{.size = {2, 3, 1}, .rotation = {{0, 1, 1}, 33}})};
    std::mt19937 random(3);
    for (const Collider& collider : all)
        for (int k = 0; k < 100; ++k) {
            const Vec3 p = random_point(random), q = random_point(random);
            const Vec3 low{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)}, high = p + q - low;
            const double bound = collider.distance_to_box(low, high);
            for (double s : {0., 0.3, 1.}) EXPECT_LE(bound, collider.distance(p + s * (q - p)).value + 1e-12);
        }
}

template <class Shape>
void expect_refused(const Shape& shape, const std::string& field) {
    try {
        const Collider collider(shape);
        ADD_FAILURE() << field << " accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
}

TEST(Colliders, with_wrong_settings_are_refused_by_the_name_of_the_field) {
    expect_refused(Plane{.normal = {0, 0, 0}}, "plane.normal");
    expect_refused(Plane{.point = {nan, 0, 0}}, "plane.point");
    expect_refused(Plane{.friction = -0.1}, "friction");
    expect_refused(Plane{.friction = nan}, "friction");
    expect_refused(Plane{.friction = std::numeric_limits<double>::infinity()}, "friction");
    expect_refused(Sphere{.radius = 0}, "sphere.radius");
    expect_refused(Sphere{.radius = -1}, "sphere.radius");
    expect_refused(Sphere{.center = {0, nan, 0}, .radius = 1}, "sphere.center");
    expect_refused(Box{.size = {1, 0, 1}}, "box.size");
    expect_refused(Box{.size = {1, 1, nan}}, "box.size");
    expect_refused(Box{.size = {1, 1, 1}, .rotation = {{0, 0, 0}, 10}}, "box.rotation.axis");
    expect_refused(Box{.size = {1, 1, 1}, .rotation = {{0, 0, 1}, nan}}, "box.rotation.degrees");
}

}  // namespace
}  // namespace phyxel
