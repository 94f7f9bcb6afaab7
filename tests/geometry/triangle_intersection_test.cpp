#include "geometry/triangle_intersection.h"

#include <gtest/gtest.h>

#include "geometry/clipping_shapes.h"

using namespace phyxel;

namespace {

using Corners = std::array<Vec3, 3>;
constexpr double tolerance = 1e-9;
const Corners floor_triangle = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};

bool cross_each_other(const Corners& a, const Corners& b) {
    const bool one = intersect_triangles(a, b, tolerance).has_value();
    EXPECT_EQ(one, intersect_triangles(b, a, tolerance).has_value());
    return one;
}

std::size_t crossings(const TriangleMesh& mesh) { return find_self_intersections(mesh, build_bvh(mesh)).pairs; }

/// The same count by trying all pairs.
std::size_t crossings_of_all_pairs(const TriangleMesh& mesh) {
    std::size_t pairs = 0;
    const auto corners = [&](std::size_t t) {
        const auto& [a, b, c] = mesh.triangles[t];
        return Corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    };
    for (std::size_t s = 0; s < mesh.triangles.size(); ++s)
        for (std::size_t t = s + 1; t < mesh.triangles.size(); ++t)
            pairs += intersect_triangles(corners(s), corners(t), tolerance).has_value();
    return pairs;
}

}  // namespace

TEST(TriangleIntersection, crossing_is_found_where_it_is) {
    const auto place = intersect_triangles(floor_triangle, {{{0.2, 0.2, -1}, {0.2, 0.2, 1}, {5, 5, 0.5}}}, tolerance);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->z, 0, 1e-12);
}

TEST(TriangleIntersection, touching_is_no_crossing) {
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0.2, 0.2, 0}, {0.2, 0.2, 1}, {0.4, 0.2, 1}}}))
        << "a corner in the plane";
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0.2, 0.2, 0}, {0.4, 0.2, 0}, {0.2, 0.2, 1}}}))
        << "an edge in the plane";
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}})) << "a common edge";
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0.2, 0.2, -1e-12}, {0.2, 0.2, 1}, {0.4, 0.2, 1}}}))
        << "by rounding";
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{5, 5, -1}, {5, 5, 1}, {6, 5, 0}}})) << "beside";
}

TEST(TriangleIntersection, triangles_of_one_plane_cross_when_they_overlap_and_face_the_same_way) {
    EXPECT_TRUE(cross_each_other(floor_triangle, {{{0.1, 0.1, 0}, {1.1, 0.1, 0}, {0.1, 1.1, 0}}}));
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0.1, 0.1, 0}, {0.1, 1.1, 0}, {1.1, 0.1, 0}}})) << "back to back";
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}})) << "neighbours";
}

TEST(TriangleIntersection, triangle_without_area_crosses_nothing) {
    EXPECT_FALSE(cross_each_other(floor_triangle, {{{0.2, 0.2, -1}, {0.2, 0.2, 0}, {0.2, 0.2, 1}}}));
}

TEST(SelfIntersections, clean_shapes_have_none) {
    EXPECT_EQ(crossings(make_box({1, 2, 3})), 0u);
    EXPECT_EQ(crossings(make_sphere(1)), 0u);
    EXPECT_EQ(crossings(make_torus(2, 0.5)), 0u);
    EXPECT_EQ(crossings(make_cylinder(1, 2)), 0u);
    EXPECT_EQ(crossings({}), 0u);
}

TEST(SelfIntersections, tree_finds_as_many_as_trying_all_pairs) {
    TriangleMesh bar = make_box({1, 0.3, 0.3}), turned = bar;
    for (Vec3& x : turned.vertices) x = rotation_about(normalized(Vec3{1, 2, 3}), 1) * x;
    const TriangleMesh mesh = joined(bar, moved(turned, {0.03, 0.02, 0.01}));
    const SelfIntersections found = find_self_intersections(mesh, build_bvh(mesh));
    EXPECT_GT(found.pairs, 20u);
    EXPECT_EQ(found.pairs, crossings_of_all_pairs(mesh));
    EXPECT_EQ(found.places.size(), 16u);
}

TEST(SelfIntersections, a_vertex_pushed_through_the_other_side_is_found) {
    TriangleMesh mesh = make_box({1, 1, 1});
    for (Vec3& x : mesh.vertices)
        if (x == Vec3{0, 0.5, 0}) x.y = -0.7;
    EXPECT_GT(crossings(mesh), 0u);
}

TEST(SelfIntersections, boxes_that_overlap_with_faces_in_common_planes_are_found_and_boxes_that_touch_are_not) {
    const TriangleMesh box = make_box({1, 1, 1});
    EXPECT_GT(crossings(joined(box, moved(box, {0.5, 0, 0}))), 0u);
    EXPECT_EQ(crossings(joined(box, moved(box, {1, 0, 0}))), 0u);
}
