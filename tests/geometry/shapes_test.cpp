#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "geometry/bvh.h"
#include "geometry/mesh_measure.h"
#include "phyxel/error.h"

using namespace phyxel;
using std::numbers::pi;

namespace {

/// Closed and outward: every directed edge has exactly one opposite.
bool is_closed(const TriangleMesh& mesh) {
    std::map<std::array<std::uint32_t, 2>, int> edges;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges)
        if (count != 1 || !edges.contains({edge[1], edge[0]})) return false;
    return true;
}

}  // namespace

TEST(Shapes, are_closed_outward_and_have_the_volume_of_the_smooth_shape) {
    const auto expect = [](const TriangleMesh& mesh, double volume) {
        EXPECT_TRUE(is_closed(mesh));
        EXPECT_NEAR(signed_volume(mesh) / volume, 1, 1e-12);
    };
    expect(make_box({1, 2, 3}), 6);
    expect(make_box({0.02, 0.02, 0.2}), 8e-5);
    expect(make_sphere(0.1), 4 * pi / 3 * 1e-3);
    expect(make_cylinder(0.5, 3), pi * 0.25 * 3);
    expect(make_cylinder(5, 0.001), pi * 25 * 0.001);
    expect(make_torus(2, 0.5), 2 * pi * pi * 2 * 0.25);
}

TEST(Shapes, box_has_the_given_sides_to_the_bit) {
    const Bounds box = bounding_box(make_box({0.1, 0.7, 0.3}));
    EXPECT_EQ(box.lower, (Vec3{-0.05, -0.35, -0.15}));
    EXPECT_EQ(box.upper, (Vec3{0.05, 0.35, 0.15}));
}

TEST(Shapes, stand_on_the_y_axis) {
    const Bounds cylinder = bounding_box(make_cylinder(0.5, 3)), torus = bounding_box(make_torus(2, 0.5));
    EXPECT_EQ(cylinder.size().y, 3);
    EXPECT_NEAR(cylinder.size().x, 1, 0.01);
    EXPECT_NEAR(torus.size().y, 1, 0.02);
    EXPECT_NEAR(torus.size().z, 5, 0.03);
}

TEST(Shapes, refuse_sizes_that_are_not_positive) {
    EXPECT_THROW(make_box({1, 0, 1}), Error);
    EXPECT_THROW(make_sphere(-1), Error);
    EXPECT_THROW(make_sphere(NAN), Error);
    EXPECT_THROW(make_cylinder(1, INFINITY), Error);
    EXPECT_THROW(make_torus(1, 1), Error);
}
