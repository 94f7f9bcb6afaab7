#include "base/eigen3.h"

#include <gtest/gtest.h>

#include <random>

namespace phyxel {
namespace {

Mat3 recompose(const SymmetricEigen3& eigen) {
    return eigen.vectors * Mat3::diagonal(eigen.values) * transpose(eigen.vectors);
}

void expect_eigenvalues(const Mat3& A) {
    const SymmetricEigen3 eigen = symmetric_eigen(A);
    const double scale = norm(A);
    EXPECT_LE(norm(recompose(eigen) - A), 4e-15 * scale);
    EXPECT_LE(norm(transpose(eigen.vectors) * eigen.vectors - Mat3::identity()), 4e-15);
    EXPECT_NEAR(determinant(eigen.vectors), 1, 4e-15);
    EXPECT_LE(eigen.values.x, eigen.values.y);
    EXPECT_LE(eigen.values.y, eigen.values.z);
}

TEST(SymmetricEigen, recomposes_random_matrices) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20000; ++i) {
        Mat3 A;
        for (Vec3& row : A.rows) row = {normal(random), normal(random), normal(random)};
        expect_eigenvalues(A + transpose(A));
    }
}

TEST(SymmetricEigen, recomposes_repeated_zero_and_wildly_scaled_eigenvalues) {
    const Mat3 Q = rotation_about(normalized(Vec3{1, -2, 0.5}), 1.1);
    for (const Vec3& d : {Vec3{2, 2, 2}, Vec3{1, 1, 3}, Vec3{-1, 0, 0}, Vec3{0, 0, 0}, Vec3{1e-12, 1, 1e12},
                          Vec3{1e-200, 2e-200, 5e-200}, Vec3{1e200, -1e200, 0}, Vec3{1, 1 + 1e-15, 1 - 1e-15}}) {
        const double scale = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        const Mat3 A = Q * Mat3::diagonal(d) * transpose(Q);
        const SymmetricEigen3 eigen = symmetric_eigen(A);
        EXPECT_TRUE(is_finite(eigen.values));
        if (scale > 0) {
            EXPECT_LE(norm((recompose(eigen) - A) * (1 / scale)), 1e-14);
        }
        EXPECT_LE(norm(transpose(eigen.vectors) * eigen.vectors - Mat3::identity()), 4e-15);
    }
}

TEST(SymmetricEigen, values_of_a_diagonal_matrix_are_exact_and_sorted) {
    const SymmetricEigen3 eigen = symmetric_eigen(Mat3::diagonal({3, -1, 2}));
    EXPECT_EQ(eigen.values, (Vec3{-1, 2, 3}));
}

}  // namespace
}  // namespace phyxel
