#include "base/polar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "base/rotation.h"
#include "base/svd.h"

namespace phyxel {
namespace {

class Draw {
public:
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    double normal() { return std::normal_distribution<double>()(random_); }
    Mat3 rotation() { return polar_detail::rotation_of_quaternion(normal(), Vec3{normal(), normal(), normal()}); }

private:
    std::mt19937 random_{3};
};

/// R Q diag(s) Q^T with random rotations and stretches from the given range, the smallest times `factor`.
Mat3 random_gradient(Draw& draw, double low, double high, double factor) {
    double s[3] = {draw.uniform(low, high), draw.uniform(low, high), draw.uniform(low, high)};
    std::sort(s, s + 3);
    const Mat3 Q = draw.rotation();
    return draw.rotation() * Q * Mat3::diagonal({factor * s[0], s[1], s[2]}) * transpose(Q);
}

double worst_distance_from_svd(double low, double high, double factor) {
    Draw draw;
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const Mat3 F = random_gradient(draw, low, high, factor);
        worst = std::max(worst, norm(polar_rotation(F) - polar_detail::rotation_by_svd(F)));
    }
    return worst;
}

TEST(PolarRotation, equals_the_singular_value_decomposition_under_mild_stretch) {
    EXPECT_LE(worst_distance_from_svd(0.8, 1.25, 1), 5e-15);
}

TEST(PolarRotation, equals_the_singular_value_decomposition_under_strong_stretch) {
    EXPECT_LE(worst_distance_from_svd(0.2, 3, 1), 5e-15);
}

TEST(PolarRotation, equals_the_singular_value_decomposition_when_inverted) {
    // The gaps between the eigenvalues are a tenth of those at rest, and the rotation is that much less sharp.
    EXPECT_LE(worst_distance_from_svd(0.6, 1.4, -0.5), 1e-14);
}

TEST(PolarRotation, equals_the_singular_value_decomposition_when_nearly_singular) {
    EXPECT_LE(worst_distance_from_svd(0.6, 1.4, 1e-8), 5e-15);
}

TEST(PolarRotation, is_the_nearest_rotation) {
    Draw draw;
    for (int i = 0; i < 200; ++i) {
        const Mat3 F = random_gradient(draw, 0.1, 2, i % 2 ? -1 : 1);
        const Mat3 R = polar_rotation(F);
        expect_rotation(R);
        for (int k = 0; k < 200; ++k) EXPECT_GE(norm(F - draw.rotation()), norm(F - R) - 1e-14);
    }
}

TEST(PolarRotation, returns_rotations_unchanged_at_any_angle) {
    Draw draw;
    EXPECT_EQ(polar_rotation(Mat3::identity()), Mat3::identity());
    for (int i = 0; i < 1000; ++i) {
        const Vec3 axis = normalized(Vec3{draw.normal(), draw.normal(), draw.normal()});
        for (const double angle : {1e-9, 1.0, 2.0, std::numbers::pi - 1e-9, std::numbers::pi}) {
            const Mat3 R = rotation_about(axis, angle);
            EXPECT_LE(norm(polar_rotation(R) - R), 5e-15) << angle;
        }
    }
}

TEST(PolarRotation, is_a_rotation_for_every_singular_reflected_or_extreme_matrix) {
    const Mat3 U = rotation_about(normalized(Vec3{1, 2, 3}), 2.0),
               V = rotation_about(normalized(Vec3{-1, 1, 0.2}), 0.7);
    for (const Vec3& d : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 1, -1}, Vec3{-1, -1, -1}, Vec3{2, 1, -1},
                          Vec3{1, 1e-9, 1e-9}, Vec3{1, 1e-9, -1e-9}, Vec3{1e-60, 1e-60, 1e-60}, Vec3{1e90, 1e90, 1e90},
                          Vec3{1e-200, 1e-200, 2e-200}, Vec3{1e200, 2e200, 3e200}}) {
        expect_rotation(polar_rotation(Mat3::diagonal(d)));
        expect_rotation(polar_rotation(U * Mat3::diagonal(d) * transpose(V)));
    }
}

TEST(PolarRotation, turns_with_the_matrix) {
    Draw draw;
    for (int i = 0; i < 1000; ++i) {
        const Mat3 F = random_gradient(draw, 0.3, 2, 1), Q = draw.rotation();
        EXPECT_LE(norm(polar_rotation(Q * F) - Q * polar_rotation(F)), 2e-14);
    }
}

}  // namespace
}  // namespace phyxel
