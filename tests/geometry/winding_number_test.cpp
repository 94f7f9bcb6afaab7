#include "geometry/winding_number.h"

#include <gtest/gtest.h>

#include <random>

using namespace phyxel;

namespace {

/// Points in and around the mesh's box, the same on every run.
std::vector<Vec3> points_around(const TriangleMesh& mesh, std::size_t count) {
    std::mt19937 generator(7);
    const auto unit = [&] { return static_cast<double>(generator()) / 4294967295.0; };
    const Bounds box = bounding_box(mesh);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 s = box.size();
        points.push_back(box.lower - 0.3 * s + 1.6 * Vec3{unit() * s.x, unit() * s.y, unit() * s.z});
    }
    return points;
}

double worst_error(const TriangleMesh& mesh) {
    const WindingNumber winding_number(mesh);
    double worst = 0;
    for (const Vec3& q : points_around(mesh, 1000))
        worst = std::max(worst, std::abs(winding_number(q) - exact_winding_number(mesh, q)));
    return worst;
}

TriangleMesh without_every(TriangleMesh mesh, std::size_t stride) {
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (t % stride) kept.push_back(mesh.triangles[t]);
    mesh.triangles = kept;
    return mesh;
}

}  // namespace

TEST(WindingNumber, tree_agrees_with_the_exact_sum_within_three_thousandths) {
    EXPECT_LT(worst_error(make_sphere(1)), 0.003);
    EXPECT_LT(worst_error(make_torus(2, 0.3)), 0.003);
    EXPECT_LT(worst_error(make_box({1, 0.1, 3})), 0.003);
    EXPECT_LT(worst_error(without_every(make_sphere(1), 7)), 0.003);
    EXPECT_LT(worst_error(without_every(make_torus(2, 0.9), 3)), 0.003);
}

TEST(WindingNumber, is_one_inside_and_zero_outside_a_closed_surface) {
    const TriangleMesh sphere = make_sphere(2);
    const WindingNumber winding_number(sphere);
    for (const Vec3& q : points_around(sphere, 2000))
        if (std::abs(norm(q) - 2) > 0.02) {
            EXPECT_EQ(winding_number.inside(q), norm(q) < 2) << norm(q);
        }
    EXPECT_NEAR(exact_winding_number(sphere, {0.3, 0.2, 0.1}), 1, 1e-12);
    EXPECT_NEAR(exact_winding_number(sphere, {3, 0.2, 0.1}), 0, 1e-12);
}

TEST(WindingNumber, is_the_same_in_any_unit) {
    const TriangleMesh sphere = make_sphere(1);
    for (const double scale : {1e-100, 1e100}) {
        TriangleMesh scaled = sphere;
        for (Vec3& x : scaled.vertices) x *= scale;
        EXPECT_NEAR(WindingNumber(scaled)(Vec3{0.1, 0.2, 0.3} * scale), 1, 0.003);
        EXPECT_NEAR(WindingNumber(scaled)(Vec3{1.1, 0.2, 0.3} * scale), 0, 0.003);
    }
}

TEST(WindingNumber, of_no_triangles_is_zero) { EXPECT_EQ(WindingNumber(TriangleMesh{})({1, 2, 3}), 0); }
