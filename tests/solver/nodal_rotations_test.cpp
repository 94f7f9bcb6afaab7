#include "solver/nodal_rotations.h"

#include <gtest/gtest.h>

#include "model/modelled.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

std::vector<Mat3> rotations_at(const Model& m, const Mat3& F) {
    const std::vector<Vec3> x = affine(m, F, {1, 2, 3});
    std::vector<Mat3> rotation(x.size());
    NodalRotations(m, threads)
        .find(
            x, threads, [](std::size_t) { return true; }, rotation);
    return rotation;
}

double largest_difference_from(const Mat3& R, std::span<const Mat3> rotations) {
    double largest = 0;
    for (const Mat3& A : rotations)
        for (std::size_t r = 0; r < 3; ++r) largest = std::max(largest, norm(A.rows[r] - R.rows[r]));
    return largest;
}

TEST(NodalRotations, are_those_of_an_affine_motion_everywhere) {
    const Model m = modelled(make_sphere(0.5), settings_of(all_schemes()[0]), 0.15);
    const Mat3 R = some_rotation();
    const Mat3 stretch = {{{1.3, 0.1, 0}, {0.1, 0.9, 0.05}, {0, 0.05, 1.1}}};
    EXPECT_LE(largest_difference_from(R, rotations_at(m, R * stretch)), 1e-12);
}

TEST(NodalRotations, are_none_where_a_body_is_flat_or_inverted) {
    const Model m = modelled(make_box({1, 0.8, 0.6}), settings_of(all_schemes()[0]), 0.2);
    for (const double height : {0.01, -1.0})
        EXPECT_EQ(largest_difference_from(Mat3::identity(), rotations_at(m, Mat3::diagonal({1, 1, height}))), 0);
}

}  // namespace
}  // namespace phyxel
