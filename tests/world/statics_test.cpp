/// Equilibrium: the beams of Brunet et al. 2019, section 4.1, hanging bodies, grips, and what has no equilibrium.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "world/brunet_beam.h"
#include "world/hanging_cube.h"
#include "world/motion.h"

namespace phyxel {
namespace {

void expect_beams(double spacing, double bending_bound, double stretching_bound) {
    Beam down(spacing, bending);
    const StepReport first = down.world.step();
    ASSERT_EQ(first.status, StepStatus::ok) << first.message;
    EXPECT_LE(first.newton_iterations, 7u);
    EXPECT_NEAR(down.displacement().y, bent, bending_bound * std::abs(bent));
    EXPECT_LT(std::abs(down.displacement().x), 1e-9);

    Beam out(spacing, stretching);
    const StepReport second = out.world.step();
    ASSERT_EQ(second.status, StepStatus::ok) << second.message;
    EXPECT_LE(second.newton_iterations, 7u);
    EXPECT_NEAR(out.displacement().z, stretched, stretching_bound * stretched);
    EXPECT_LT(std::abs(out.displacement().x) + std::abs(out.displacement().y), 1e-9);
}

TEST(Statics, beams_deflect_as_converged_finite_elements_do_and_not_sideways) { expect_beams(0.01, 0.008, 0.006); }
TEST(Statics, LONG_beams_of_496_nodes) { expect_beams(0.02 / 3, 0.004, 0.0045); }
TEST(Statics, LONG_beams_of_1025_nodes) { expect_beams(0.005, 0.0025, 0.002); }
TEST(Statics, LONG_beams_of_2989_nodes) { expect_beams(0.01 / 3, 0.0015, 0.0015); }

TEST(Statics, beams_on_a_turned_lattice_deflect_alike) {
    BodySettings turned;
    turned.lattice_rotation = {{1, 2, 3}, 40};
    turned.lattice_offset = {0.3, 0.1, 0.4};
    Beam down(0.01, bending, turned), out(0.01, stretching, turned);
    ASSERT_EQ(down.world.step().status, StepStatus::ok);
    ASSERT_EQ(out.world.step().status, StepStatus::ok);
    EXPECT_NEAR(down.displacement().y, bent, 0.03 * std::abs(bent));
    EXPECT_NEAR(out.displacement().z, stretched, 0.03 * stretched);
}

TEST(Statics, reactions_balance_the_load_in_force_and_torque) {
    for (const AxisAngle& lattice : {AxisAngle{{0, 0, 1}, 0}, AxisAngle{{1, 2, 3}, 40}}) {
        BodySettings settings;
        settings.lattice_rotation = lattice;
        Beam beam(0.01, bending, settings);
        ASSERT_EQ(beam.world.step().status, StepStatus::ok);
        const Reaction reaction = beam.world.reaction(beam.grip);
        EXPECT_LT(norm(reaction.force + bending), 1e-6 * norm(bending));
        // The load acts where the end face is now: 0.2 m less what bending took away.
        EXPECT_NEAR(reaction.torque.x, -12 * (0.2 + beam.displacement().z), 0.01 * 12 * 0.2);
        EXPECT_LT(beam.world.energy().balance_error, 1e-6);
    }
}

TEST(Statics, a_hanging_cube_sags_by_its_weight_at_every_stiffness) {
    for (double E : {1e5, 1e7, 1e9, 1e11}) {
        HangingCube cube(E, {.time_step = 1, .integrator = Integrator::statics});
        const StepReport report = cube.world.step();
        ASSERT_EQ(report.status, StepStatus::ok) << report.message;
        EXPECT_NEAR(cube.sag(), cube.expected_sag, 0.02 * cube.expected_sag) << E;
    }
}

TEST(Statics, a_grip_that_pulls_meets_the_force_of_the_stretched_bar) {
    const double E = 1e6, strain = 0.05, area = 0.02 * 0.02;
    World world({.time_step = 1, .gravity = {}, .integrator = Integrator::statics});
    BodySettings settings;
    settings.spacing = 0.005;
    settings.material = corotated({.density = 1000, .youngs_modulus = E, .poissons_ratio = 0});
    const BodyId body = world.add_body(make_box({0.02, 0.02, 0.1}), settings);
    world.add_fix(body, {.box = {{-1, -1, -0.05}, {1, 1, -0.05}}});
    const std::size_t grip = world.add_fix(
        body, {.box = {{-1, -1, 0.05}, {1, 1, 0.05}}, .path = {{0, {}, 0}, {1, {0, 0, 0.1 * strain}, 0}}});
    ASSERT_EQ(world.step().status, StepStatus::ok);
    // A node of the face is no point of it: the clamp errs by the square of the spacing.
    EXPECT_NEAR(world.reaction(grip).force.z, E * area * strain, 1e-3 * E * area * strain);
    const double stored = 0.5 * E * strain * strain * area * 0.1;
    EXPECT_NEAR(world.energy().elastic, stored, 1e-3 * stored);
}

TEST(Statics, a_bar_twisted_by_a_half_turn_is_found_in_load_steps) {
    World world({.time_step = 1, .gravity = {}, .integrator = Integrator::statics});
    BodySettings settings;
    settings.spacing = 0.01;
    settings.material = neo_hookean({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3});
    const BodyId body = world.add_body(make_box({0.02, 0.02, 0.1}), settings);
    world.add_fix(body, {.box = {{-1, -1, -0.05}, {1, 1, -0.05}}});
    world.add_fix(body, {.box = {{-1, -1, 0.05}, {1, 1, 0.05}}, .path = {{0, {}, 0}, {1, {}, 180}}});
    const std::size_t corner = world.add_probe(body, {0.01, 0.01, 0}), axis = world.add_probe(body, {0, 0, 0});
    const StepReport report = world.step();
    ASSERT_EQ(report.status, StepStatus::ok) << report.message;
    const Vec3 arm = world.probe(corner).position - world.probe(axis).position;
    // Half of the turn in the middle.
    EXPECT_NEAR(std::atan2(arm.y, arm.x) * 180 / std::numbers::pi, 135, 3);
}

TEST(Statics, what_is_not_held_is_refused_with_the_reason_and_stays_where_it_is) {
    World world({.time_step = 1, .integrator = Integrator::statics});
    const BodyId body = world.add_body(make_box({0.1, 0.1, 0.1}), small_body());
    const std::vector<Vec3> before(world.positions(body).begin(), world.positions(body).end());
    // A face that slides in its plane leaves three motions.
    world.add_fix(body, {.box = {{-1, 0.05, -1}, {1, 1, 1}}, .x = false, .z = false});
    const StepReport report = world.step();
    EXPECT_EQ(report.status, StepStatus::failed);
    EXPECT_NE(report.message.find("free to move"), std::string::npos) << report.message;
    EXPECT_TRUE(std::equal(before.begin(), before.end(), world.positions(body).begin()));
}

TEST(Statics, a_load_that_crushes_the_law_ends_in_a_diagnosis_and_never_in_a_state) {
    // Hooke's law with Green strain has no state that carries this pressure.
    World world({.time_step = 1, .gravity = {}, .integrator = Integrator::statics});
    BodySettings settings = small_body();
    settings.material.law = Law::saint_venant_kirchhoff;
    const BodyId body = world.add_body(make_box({0.1, 0.1, 0.1}), settings);
    world.add_fix(body, {.box = {{-1, -1, -1}, {1, -0.05, 1}}});
    world.add_load(body, {.box = {{-1, 0.05, -1}, {1, 1, 1}}, .traction = Vec3{0, -1e5, 0}});
    const std::vector<Vec3> before(world.positions(body).begin(), world.positions(body).end());
    const StepReport report = world.step();
    if (report.status == StepStatus::failed) {
        EXPECT_NE(report.message.find("no equilibrium was found"), std::string::npos) << report.message;
        EXPECT_TRUE(std::equal(before.begin(), before.end(), world.positions(body).begin()));
    } else {
        // Or a collapsed one, which is an equilibrium all the same: the reaction carries the load.
        EXPECT_NEAR(world.reaction(0).force.y, 1e5 * 0.01, 1e-3 * 1e5 * 0.01);
    }
    EXPECT_TRUE(all_finite(world, body));
}

TEST(Statics, gives_the_same_bits_for_any_number_of_threads) {
    const auto hash = [](int threads) {
        World world({.time_step = 1, .integrator = Integrator::statics, .threads = threads});
        const BodyId body = world.add_body(make_box({0.3, 0.1, 0.1}), small_body());
        world.add_fix(body, {.box = {{-0.15, -1, -1}, {-0.15, 1, 1}}});
        EXPECT_EQ(world.step().status, StepStatus::ok);
        return world.state_hash();
    };
    const std::uint64_t expected = hash(1);
    for (int threads : {2, 3, 8}) EXPECT_EQ(hash(threads), expected) << threads;
}

}  // namespace
}  // namespace phyxel
