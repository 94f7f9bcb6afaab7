#include <gtest/gtest.h>

#include <numbers>

#include "solver/dynamics.h"
#include "support/measured.h"

/// Free vibrations: what the stabilization is for. Node coefficients in a checkerboard hardly show in the smooth field
/// of moving least squares, so that without it there are soft modes that no solid has.

namespace phyxel {
namespace {

/// Frequencies of the free cube of 6^3 whole cells over its Lamé frequency sqrt(2) pi c_s / L.
std::vector<double> cube_spectrum(double alpha) {
    BodySettings settings = settings_of(all_schemes()[2]);
    settings.stabilization = alpha;
    constexpr double a = 0.1;
    const Model m = whole_cell_model({6, 6, 6}, a, settings);
    const double lame_frequency =
        std::numbers::sqrt2 * std::numbers::pi * shear_wave_speed(m.material.lame, settings.material.density) / (6 * a);
    std::vector<double> omega = frequencies(m);
    for (double& w : omega) w /= lame_frequency;
    return omega;
}

auto count_below(const std::vector<double>& omega, double limit) {
    return std::lower_bound(omega.begin(), omega.end(), limit) - omega.begin();
}

TEST(Modes, free_cube_with_points_at_nodes_has_the_low_modes_of_the_solid) {
    const std::vector<double> omega = cube_spectrum(0.5);
    EXPECT_LE(omega[5], 1e-6);
    EXPECT_GT(omega[6], 0.1);
    EXPECT_EQ(count_below(omega, 0.94) - 6, 8);
    EXPECT_NEAR(omega[6], 0.626, 0.03 * 0.626);
    // The Lamé modes, whose frequency is exact: the nearest to 1.
    double nearest = 0;
    for (double w : omega)
        if (std::abs(w - 1) < std::abs(nearest - 1)) nearest = w;
    EXPECT_NEAR(nearest, 1, 0.02);
    measured("sixth", omega[5]);
    measured("lowest elastic", omega[6]);
    measured("fourteenth", omega[13]);
    measured("fifteenth", omega[14]);
    measured("Lame", nearest);
}

TEST(Modes, free_cube_without_stabilization_has_false_soft_modes) {
    const std::vector<double> omega = cube_spectrum(0);
    EXPECT_GE(count_below(omega, 0.80) - 6, 20);
    measured("modes below 0.80", double(count_below(omega, 0.80) - 6));
}

/// Frequencies of a free sphere over c_s / R; nu = 0.25.
std::vector<double> sphere_spectrum(double radius_in_spacings, double beta) {
    constexpr double a = 0.1;
    BodySettings settings = settings_of(all_schemes()[0]);
    settings.material.poissons_ratio = 0.25;
    settings.stabilization = beta;
    const double R = radius_in_spacings * a;
    const Model m = modelled(make_sphere(R), settings, a);
    std::vector<double> omega = frequencies(m);
    for (double& w : omega) w *= R / shear_wave_speed(m.material.lame, settings.material.density);
    return omega;
}

/// The five quadrupole modes of a free sphere with nu = 0.25 [c_s / R] (Lamb 1882).
constexpr double quadrupole = 2.501;

TEST(Modes, stabilization_lifts_false_modes_of_a_sphere_to_half_a_shear_wave_per_spacing) {
    // The false modes' frequency goes with c_s / a, so that in a sphere of three spacings they are the lowest.
    const std::vector<double> with = sphere_spectrum(3, 0.2), without = sphere_spectrum(3, 0);
    EXPECT_LE(with[5], 1e-6);
    EXPECT_GT(with[6] / 3, 0.45);
    EXPECT_LE(without[6] / 3, 0.15);
    measured("lowest over c_s/a", with[6] / 3);
    measured("lowest over c_s/a, not stabilized", without[6] / 3);
}

TEST(Modes, LONG_free_sphere_of_six_spacings_has_the_modes_of_the_solid) {
    const std::vector<double> omega = sphere_spectrum(6, 0.2);
    EXPECT_LE(omega[5], 1e-6);
    EXPECT_GT(omega[6], 2.3);
    for (std::size_t k = 6; k < 11; ++k) {
        EXPECT_LE(omega[k] / quadrupole, 1 - 0.035) << k;
        EXPECT_GE(omega[k] / quadrupole, 1 - 0.060) << k;
        measured("mode " + std::to_string(k - 5) + " against 2.501 c_s/R", omega[k] / quadrupole - 1);
    }
    EXPECT_GT(omega[11], 1.0 * quadrupole);
}

TEST(Modes, LONG_free_sphere_without_stabilization_has_false_soft_modes) {
    const std::vector<double> omega = sphere_spectrum(6, 0);
    EXPECT_LE(omega[6], 0.5);
    measured("lowest elastic", omega[6]);
    measured("modes below 2.3", double(count_below(omega, 2.3) - 6));
}

}  // namespace
}  // namespace phyxel
