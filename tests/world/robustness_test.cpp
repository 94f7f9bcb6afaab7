/// Stepping never throws and never leaves a NaN: whatever is done to a body, a step ends well, or it fails with a
/// diagnosis and the last good state.
#include <gtest/gtest.h>

#include <cmath>

#include "world/motion.h"

namespace phyxel {
namespace {

constexpr BoxSelection top{{-1, 0.05, -1}, {1, 0.05, 1}}, bottom{{-1, -0.05, -1}, {1, -0.05, 1}};

struct Outcome {
    StepStatus status = StepStatus::ok;
    std::size_t retries = 0, steps = 0;
    std::string message;
};

/// Steps until something fails; whatever happens, the state is finite and of one moment.
Outcome endure(World& world, BodyId body, int steps) {
    Outcome outcome;
    for (int k = 0; k < steps && outcome.status == StepStatus::ok; ++k) {
        const std::uint64_t before = world.state_hash();
        const double time = world.time();
        const StepReport report = world.step();
        EXPECT_TRUE(all_finite(world, body));
        EXPECT_TRUE(std::isfinite(world.energy().balance_error));
        outcome.status = report.status;
        outcome.retries += report.retries;
        outcome.message = report.message;
        if (report.status == StepStatus::ok) {
            ++outcome.steps;
            EXPECT_GT(report.substeps, 0u);
            EXPECT_GT(world.time(), time);
            continue;
        }
        // A failure names what happened, and leaves the last good state.
        EXPECT_FALSE(report.message.empty());
        EXPECT_EQ(report.advanced, 0);
        EXPECT_EQ(world.time(), time);
        EXPECT_EQ(world.state_hash(), before);
        // The next try is as sane as the first.
        const StepReport again = world.step();
        EXPECT_EQ(again.status, StepStatus::failed);
        EXPECT_EQ(again.message, report.message);
        EXPECT_EQ(world.state_hash(), before);
    }
    return outcome;
}
TEST(Promise, jelly_thrown_at_a_floor_at_four_times_its_speed_of_sound_survives) {
    World world({.integrator = Integrator::leap_frog});
    BodySettings settings = small_body({.translation = {0, 0.06, 0}, .velocity = {0, -20, 0}});
    settings.material = {.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.45};
    const BodyId jelly = world.add_body(cube_mesh, settings);
    world.add_collider(Plane{});
    const Outcome outcome = endure(world, jelly, 20);
    EXPECT_EQ(outcome.status, StepStatus::ok) << outcome.message;
    EXPECT_GT(outcome.retries, 0u);  // steps were cut into smaller ones, and reported
    EXPECT_GT(center_of_mass(world, jelly).y, 0.04);
    EXPECT_LT(world.energy().balance_error, 0.05);
    const auto warnings = world.warnings();
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [&](const Warning& w) {
        return w.message.find("cut into smaller") != std::string::npos && w.count == outcome.retries;
    }));
}

TEST(Promise, ordinary_impacts_need_no_second_try) {
    for (double speed : {1., 5., 10.}) {
        World world({.integrator = Integrator::leap_frog});
        const BodyId body =
            world.add_body(cube_mesh, small_body({.translation = {0, 0.06, 0}, .velocity = {0, -speed, 0}}));
        world.add_collider(Plane{});
        const Outcome outcome = endure(world, body, 6);
        EXPECT_EQ(outcome.status, StepStatus::ok) << outcome.message;
        EXPECT_EQ(outcome.retries, 0u) << speed;
    }
}

TEST(Promise, a_body_at_a_million_metres_a_second_into_the_floor_ends_with_a_diagnosis) {
    World world({.integrator = Integrator::leap_frog});
    const BodyId body = world.add_body(cube_mesh, small_body({.translation = {0, 0.06, 0}, .velocity = {0, -1e6, 0}}));
    world.add_collider(Plane{});
    const Outcome outcome = endure(world, body, 3);
    EXPECT_EQ(outcome.status, StepStatus::failed);
    EXPECT_NE(outcome.message.find("crushed"), std::string::npos) << outcome.message;
}

TEST(Promise, a_body_that_begins_inside_of_a_collider_is_pushed_out_and_warned_of) {
    for (double deep : {0.0, -0.2}) {
        World world({.integrator = Integrator::leap_frog});
        world.add_collider(Plane{});
        const BodyId body = world.add_body(cube_mesh, small_body({.translation = {0, deep, 0}}));
        ASSERT_EQ(world.warnings().size(), 1u);
        EXPECT_NE(world.warnings()[0].message.find("inside of a collider"), std::string::npos);
        EXPECT_EQ(endure(world, body, 10).status, StepStatus::ok);
        EXPECT_GT(center_of_mass(world, body).y, 0);
    }
}

TEST(Promise, grips_may_crush_a_body_and_pass_through_each_other) {
    for (Law law : {Law::neo_hookean, Law::corotated, Law::saint_venant_kirchhoff, Law::linear})
        for (double way : {-0.08, -0.099, -0.15}) {
            World world({.integrator = Integrator::leap_frog});
            BodySettings settings = small_body();
            settings.material.law = law;
            const BodyId body = world.add_body(cube_mesh, settings);
            world.add_fix(body, {.box = bottom});
            world.add_fix(body, {.box = top, .path = {{0, {}, 0}, {0.1, {0, way, 0}, 0}}});
            EXPECT_EQ(endure(world, body, 7).status, StepStatus::ok) << int(law) << ' ' << way;
        }
}

TEST(Promise, no_load_makes_a_step_throw_or_leaves_a_nan) {
    for (Law law : {Law::neo_hookean, Law::saint_venant_kirchhoff})
        for (double p : {1e4, 1e9, -1e9, 1e30}) {
            World world({.integrator = Integrator::leap_frog});
            BodySettings settings = small_body();
            settings.material.law = law;
            const BodyId body = world.add_body(cube_mesh, settings);
            world.add_load(body, {.box = {{-1, -1, -1}, {1, 1, 1}}, .pressure = p});
            EXPECT_EQ(endure(world, body, 3).status, p == 1e4 ? StepStatus::ok : StepStatus::failed) << p;
        }
    for (double force : {1e2, 1e6, 1e30}) {
        World world({.integrator = Integrator::leap_frog});
        const BodyId body = world.add_body(cube_mesh, small_body());
        world.add_fix(body, {.box = bottom});
        world.add_load(body, {.box = top, .force = Vec3{0, -force, 0}});
        EXPECT_EQ(endure(world, body, 3).status, force == 1e2 ? StepStatus::ok : StepStatus::failed) << force;
    }
}

TEST(Promise, no_gravity_makes_a_step_throw_or_leaves_a_nan) {
    for (double pull : {1e3, 1e6, 1e300}) {
        World world({.gravity = {0, -pull, 0}, .integrator = Integrator::leap_frog});
        const BodyId body = world.add_body(cube_mesh, small_body({.translation = {0, 0.06, 0}}));
        world.add_collider(Plane{});
        EXPECT_EQ(endure(world, body, 3).status, pull == 1e3 ? StepStatus::ok : StepStatus::failed) << pull;
    }
}

TEST(Promise, time_steps_may_be_tiny_and_long) {
    for (double dt : {1e-300, 1e-12, 1.0}) {
        World world({.time_step = dt, .integrator = Integrator::leap_frog});
        const BodyId body = world.add_body(cube_mesh, small_body({.translation = {0, 0.06, 0}}));
        world.add_collider(Plane{});
        EXPECT_EQ(endure(world, body, 2).status, StepStatus::ok) << dt;
    }
    World endless({.time_step = 1e9, .integrator = Integrator::leap_frog});
    EXPECT_THROW(endless.add_body(cube_mesh, small_body()), Error);
}

TEST(Promise, after_a_failure_gentler_conditions_let_the_world_go_on) {
    World world({.gravity = {0, -1e30, 0}, .integrator = Integrator::leap_frog});
    const BodyId body = world.add_body(cube_mesh, small_body());
    EXPECT_EQ(world.step().status, StepStatus::failed);
    world.set_gravity({0, -9.81, 0});
    const StepReport report = world.step();
    EXPECT_EQ(report.status, StepStatus::ok);
    EXPECT_EQ(report.retries, 0u);
    EXPECT_NEAR(center_of_mass(world, body).y, -0.5 * 9.81 / 3600, 1e-9);
}

}  // namespace
}  // namespace phyxel
