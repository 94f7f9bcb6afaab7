#include "geometry/thickness.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace phyxel;

TEST(Thickness, of_a_plate_is_its_own) {
    EXPECT_NEAR(local_thickness(make_box({1, 0.02, 1})).thinnest, 0.02, 1e-12);
    EXPECT_NEAR(local_thickness(make_box({1, 1, 1})).thinnest, 1, 1e-12);
}

TEST(Thickness, of_round_bodies_is_the_diameter) {
    EXPECT_NEAR(local_thickness(make_sphere(1)).thinnest, 2, 0.02);
    EXPECT_NEAR(local_thickness(make_torus(2, 0.5)).thinnest, 1, 0.03);
}

TEST(Thickness, finds_the_thin_part_and_names_its_place) {
    // A cube with a thin plate beside it
    TriangleMesh mesh = make_box({1, 1, 1});
    const TriangleMesh plate = make_box({1, 0.05, 1});
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& x : plate.vertices) mesh.vertices.push_back(x + Vec3{5, 0, 0});
    for (const auto& [a, b, c] : plate.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
    const Thickness thickness = local_thickness(mesh);
    EXPECT_NEAR(thickness.thinnest, 0.05, 1e-12);
    EXPECT_NEAR(thickness.place.x, 5, 0.5);
}

TEST(Thickness, sharp_edges_of_a_wedge_do_not_count) {
    // A prism over a 30 degree corner, fine towards its edge; 1 % of its area is thinner than about 1 % of its height
    TriangleMesh mesh = make_box({1, 1, 1});
    for (Vec3& x : mesh.vertices) x.y *= (x.x + 0.5) + 1e-3;
    EXPECT_GT(local_thickness(mesh).thinnest, 0.01);
}

TEST(Thickness, without_an_opposite_side_is_infinite) {
    TriangleMesh sheet;
    sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}};
    EXPECT_TRUE(std::isinf(local_thickness(sheet).thinnest));
    EXPECT_TRUE(std::isinf(local_thickness({}).thinnest));
}
