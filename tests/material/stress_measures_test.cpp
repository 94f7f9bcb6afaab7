#include "material/stress_measures.h"

#include <gtest/gtest.h>

#include "material/lame.h"
#include "material/law.h"

namespace phyxel {
namespace {

TEST(StressMeasures, von_mises_of_uniaxial_tension_shear_and_pressure) {
    EXPECT_DOUBLE_EQ(von_mises(Mat3::diagonal({5, 0, 0})), 5);
    EXPECT_NEAR(von_mises({{{0, 2, 0}, {2, 0, 0}, {0, 0, 0}}}), 2 * std::sqrt(3.0), 1e-15);
    EXPECT_EQ(von_mises(Mat3::diagonal({-7, -7, -7})), 0);
}

TEST(StressMeasures, principal_stresses_come_largest_first_in_any_frame) {
    const Mat3 Q = rotation_about(normalized(Vec3{1, -1, 2}), 0.8);
    const Vec3 found = principal(Q * Mat3::diagonal({-3, 7, 2}) * transpose(Q));
    EXPECT_NEAR(found.x, 7, 1e-14);
    EXPECT_NEAR(found.y, 2, 1e-14);
    EXPECT_NEAR(found.z, -3, 1e-14);
}

TEST(StressMeasures, cauchy_stress_is_force_per_current_area) {
    // A bar of stretch 2 whose sides shrink to 1/2: a quarter of the area carries the force, at four times the stress.
    const Mat3 sigma = cauchy_stress(Mat3::diagonal({2, 0.5, 0.5}), Mat3::diagonal({100, 0, 0}));
    EXPECT_DOUBLE_EQ(sigma(0, 0), 400);
    EXPECT_EQ(sigma(1, 1), 0);
}

TEST(StressMeasures, cauchy_stress_of_a_point_without_volume_is_zero) {
    EXPECT_EQ(cauchy_stress(Mat3::diagonal({1, 1, 0}), Mat3::diagonal({1, 2, 3})), Mat3{});
}

TEST(Lame, moduli_and_wave_speeds_of_steel) {
    // nu = 0.3: lambda = 1.5 mu, lambda + 2 mu = 3.5 mu; handbook speeds 5.9 and 3.2 km/s.
    const Lame m = lame({.density = 7850, .youngs_modulus = 2.1e11, .poissons_ratio = 0.3});
    EXPECT_NEAR(m.lambda / m.mu, 1.5, 1e-14);
    EXPECT_NEAR(p_wave_modulus(m) / m.mu, 3.5, 1e-14);
    EXPECT_NEAR(bulk_modulus(m), 1.75e11, 1e-4);
    EXPECT_NEAR(pressure_wave_speed(m, 7850), 6001, 1);
    EXPECT_NEAR(shear_wave_speed(m, 7850), 3208, 1);
}

}  // namespace
}  // namespace phyxel
