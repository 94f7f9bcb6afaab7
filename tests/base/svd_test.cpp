#include "base/svd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/rotation.h"

namespace phyxel {
namespace {

Mat3 random_matrix(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Mat3 A;
    for (Vec3& row : A.rows) row = {normal(random), normal(random), normal(random)};
    return A;
}

void expect_singular_values(const Mat3& A) {
    const Svd3 svd = rotation_variant_svd(A);
    const double scale = std::max(svd.values.x, 1e-300);
    EXPECT_LE(norm((svd.U * Mat3::diagonal(svd.values) * transpose(svd.V) - A) * (1 / scale)), 1e-14);
    expect_rotation(svd.U);
    expect_rotation(svd.V);
    EXPECT_GE(svd.values.x, svd.values.y * (1 - 1e-15));
    EXPECT_GE(svd.values.y, std::abs(svd.values.z) * (1 - 1e-15));
}

TEST(RotationVariantSvd, recomposes_random_matrices_by_rotations_with_the_sign_in_the_last_value) {
    std::mt19937 random(2);
    for (int i = 0; i < 20000; ++i) {
        const Mat3 A = random_matrix(random);
        expect_singular_values(A);
        const double det = determinant(A);
        EXPECT_EQ(rotation_variant_svd(A).values.z > 0, det > 0) << det;
    }
}

TEST(RotationVariantSvd, recomposes_singular_repeated_and_wildly_scaled_values) {
    const Mat3 U = rotation_about(normalized(Vec3{1, 2, 3}), 2.0),
               V = rotation_about(normalized(Vec3{-1, 1, 0.2}), 0.7);
    for (const Vec3& d : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 2}, Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{1, 1, -1},
                          Vec3{-1, -1, -1}, Vec3{2, 1, 1}, Vec3{1, 1e-9, 1e-18}, Vec3{1e150, 1e-150, 1},
                          Vec3{1e-200, 2e-200, 3e-200}, Vec3{1e200, 1e200, -1e200}}) {
        expect_singular_values(U * Mat3::diagonal(d) * transpose(V));
        expect_singular_values(Mat3::diagonal(d));
    }
}

TEST(RotationVariantSvd, keeps_the_digits_of_small_values) {
    // A^T A would lose 1e-10 altogether.
    const Mat3 U = rotation_about({0, 0, 1}, 0.3), V = rotation_about({1, 0, 0}, 0.4);
    const Svd3 svd = rotation_variant_svd(U * Mat3::diagonal({1, 0.5, 1e-10}) * transpose(V));
    EXPECT_NEAR(svd.values.x, 1, 1e-15);
    EXPECT_NEAR(svd.values.y, 0.5, 1e-15);
    EXPECT_NEAR(svd.values.z, 1e-10, 1e-15);
}

}  // namespace
}  // namespace phyxel
