/// A cube of 0.1 m that hangs from its upper face and comes to rest, from jelly to steel, at one and the same step.
#include "world/hanging_cube.h"

#include <gtest/gtest.h>

#include <sstream>

#include "reference/fem/solve.h"
#include "support/measured.h"

namespace phyxel {
namespace {

/// Where the middle of the lower face comes to rest below its place, by triquadratic hexahedra [m].
double sag_of_elements(double youngs_modulus, double ratio) {
    constexpr double L = HangingCube::L;
    const Material material =
        corotated({.density = HangingCube::density, .youngs_modulus = youngs_modulus, .poissons_ratio = ratio});
    const fem::Solid solid(fem::box_mesh(fem::ElementType::hexahedra_27, {4, 4, 4}, {L, L, L}), material);
    fem::Conditions conditions(solid);
    fem::clamp(conditions, solid, fem::Face::y_max);
    fem::add_gravity(conditions, solid, {0, -g, 0});
    const fem::StaticResult result = fem::solve_static(solid, conditions);
    EXPECT_TRUE(result.converged);
    return -fem::interpolate(solid.mesh, result.displacement, {L / 2, 0, L / 2}).y;
}

/// A second of damped motion against the elements' equilibrium, and that of a bar where strains are small.
void expect_sag(double youngs_modulus, double ratio) {
    HangingCube cube(youngs_modulus,
                     {.time_step = 1.0 / 60, .integrator = Integrator::implicit_euler, .mass_damping = 20}, ratio);
    for (int k = 0; k < 60; ++k) ASSERT_EQ(cube.world.step().status, StepStatus::ok) << youngs_modulus;
    const double expected = sag_of_elements(youngs_modulus, ratio);
    EXPECT_NEAR(cube.sag(), expected, 0.02 * expected) << youngs_modulus << ", " << ratio;
    std::ostringstream name;
    name << "E " << youngs_modulus << ", nu " << ratio;
    measured(name.str(), cube.sag() / expected - 1);
    if (ratio > 0 || HangingCube::density * g * HangingCube::L / youngs_modulus > 0.01) return;
    EXPECT_NEAR(cube.sag(), cube.expected_sag, 0.02 * cube.expected_sag) << youngs_modulus;
}

// All of them are 0.8 % above the elements without a Poisson's ratio, and 1.1 % with 0.3.
TEST(Sag, of_the_softest_cube_is_that_of_finite_elements) { expect_sag(1e4, 0.3); }

TEST(Sag, LONG_of_any_stiffness_is_that_of_finite_elements) {
    for (double ratio : {0.0, 0.3})
        for (double youngs_modulus : {1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11}) expect_sag(youngs_modulus, ratio);
}

}  // namespace
}  // namespace phyxel
