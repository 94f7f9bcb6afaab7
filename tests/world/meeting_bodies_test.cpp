/// Soft bodies that meet each other in implicit steps.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/temporary_directory.h"
#include "world/motion.h"

namespace phyxel {
namespace {

WorldSettings implicit(WorldSettings settings = {}) {
    settings.integrator = Integrator::implicit_euler;
    return settings;
}

TEST(MeetingBodies, exchange_momentum_and_lose_none_but_for_what_the_step_is_solved_to) {
    World world(implicit({.time_step = 1e-3, .gravity = {}}));
    const BodyId left = world.add_body(cube_mesh, small_body({.translation = {-0.06, 0, 0}, .velocity = {1, 0, 0}}));
    BodySettings lighter = small_body({.translation = {0.06, 0.01, 0}, .velocity = {-1, 0, 0}});
    lighter.spacing = 0.03;
    lighter.material.density = 500;
    const BodyId right = world.add_body(make_sphere(0.05), lighter);
    const auto momentum = [&](auto&& of) { return of(left) + of(right); };
    const auto linear = [&](BodyId body) { return world.report(body).mass * mean_velocity(world, body); };
    const auto angular = [&](BodyId body) {
        Vec3 sum{};
        for (std::size_t i = 0; i < world.masses(body).size(); ++i)
            sum += world.masses(body)[i] * cross(world.positions(body)[i], world.velocities(body)[i]);
        return sum;
    };
    const Vec3 p = momentum(linear), l = momentum(angular);
    const double size = 2 * world.report(left).mass;
    take_steps(world, 100);
    EXPECT_GT(mean_velocity(world, right).x, 0.5);  // it was hit by the heavier one
    EXPECT_LT(norm(momentum(linear) - p), 1e-4 * size);
    // A pair pushes along its normal, which is off the line between its ends by the friction it bears.
    EXPECT_LT(norm(momentum(angular) - l), 1e-3 * size * 0.05);
    EXPECT_LT(world.energy().balance_error, 1e-3);
}

TEST(MeetingBodies, rest_on_each_other_with_the_weight_of_what_lies_above) {
    World world(implicit());
    const BodySettings low = small_body({.translation = {0, 0.05, 0}});
    BodySettings high = small_body({.translation = {0, 0.155, 0}});
    high.spacing = 0.02;
    const BodyId base = world.add_body(cube_mesh, low);
    const BodyId load = world.add_body(cube_mesh, high);
    world.add_collider(Plane{});
    const std::size_t top = world.add_probe(base, {0, 0.1, 0}), bottom = world.add_probe(load, {0, 0.105, 0});
    take_steps(world, 120);
    // As quiet as steps are that are solved to a share of the way of a free one.
    const double slowest = default_step_tolerance * g / 60;
    EXPECT_LT(world.energy().kinetic, 0.5 * 2 * world.report(base).mass * slowest * slowest);
    const double gap = world.probe(bottom).position.y - world.probe(top).position.y;
    EXPECT_LT(std::abs(gap), 0.02 * 0.025);
    // The base is shorter by the load above it and by half of its own weight.
    const double sag = 1.5 * 1000 * g * 0.1 * 0.1 / 1e5;
    EXPECT_NEAR(0.1 - world.probe(top).position.y, sag, 0.25 * sag);
    EXPECT_LT(norm(center_of_mass(world, load) - Vec3{0, center_of_mass(world, load).y, 0}), 1e-3);
}

constexpr double slope = std::numbers::pi / 9;

/// How far a cube of friction `mu` slides in `seconds` on another body that lies on a slope of 20 degrees.
double slide(double mu, double seconds) {
    World world(implicit({.gravity = {g * std::sin(slope), -g * std::cos(slope), 0}}));
    BodySettings ground = small_body({.translation = {0.2, -0.025, 0}});
    ground.friction = mu;
    ground.material.youngs_modulus = 1e7;
    const BodyId plate = world.add_body(make_box({0.6, 0.05, 0.15}), ground);
    world.add_fix(plate, {.box = {{-2, -2, -2}, {2, -0.05, 2}}});
    BodySettings settings = small_body({.translation = {0, 0.05, 0}});
    settings.friction = mu;
    settings.material.youngs_modulus = 1e6;
    const BodyId cube = world.add_body(cube_mesh, settings);
    take_steps(world, static_cast<int>(std::lround(60 * seconds)));
    return center_of_mass(world, cube).x;
}

TEST(MeetingBodies, hold_each_other_by_friction_below_its_angle_and_slide_as_coulomb_says_beyond) {
    constexpr double t = 0.5;
    EXPECT_LT(std::abs(slide(0.5, 1)), 1e-3);  // tan 20 degrees = 0.364
    for (double mu : {0.0, 0.2}) {
        const double expected = 0.5 * g * (std::sin(slope) - mu * std::cos(slope)) * t * t;
        EXPECT_NEAR(slide(mu, t), expected, 0.06 * expected) << mu;  // first order steps of 1/60 s add dt/t, 3 %
    }
}

/// A pile of different shapes, falling.
struct Pile {
    explicit Pile(WorldSettings settings) : world(settings) {
        bodies.push_back(world.add_body(cube_mesh, small_body({.translation = {0, 0.052, 0}, .spacing = 0.034})));
        bodies.push_back(
            world.add_body(make_box({0.15, 0.05, 0.08}),
                           small_body({.translation = {0.02, 0.15, 0}, .velocity = {0, -1, 0}, .spacing = 0.03})));
        bodies.push_back(
            world.add_body(make_torus(0.07, 0.03),
                           small_body({.translation = {0, 0.23, 0.01}, .velocity = {0, -2, 0}, .spacing = 0.03})));
        world.add_collider(Plane{});
    }
    World world;
    std::vector<BodyId> bodies;
};

TEST(MeetingBodies, have_the_same_bits_for_any_number_of_threads_and_after_a_resume) {
    for (Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
        Pile one({.integrator = integrator, .threads = 1});
        take_steps(one.world, 6);
        const test::TemporaryDirectory folder;
        one.world.save_checkpoint(folder / "checkpoint");
        take_steps(one.world, 3);
        for (int threads : integrator == Integrator::bdf2 ? std::vector<int>{} : std::vector{2, 3, 8}) {
            Pile many({.integrator = integrator, .threads = threads});
            take_steps(many.world, 9);
            EXPECT_EQ(many.world.state_hash(), one.world.state_hash()) << threads;
        }
        Pile resumed({.integrator = integrator});
        resumed.world.load_checkpoint(folder / "checkpoint");
        take_steps(resumed.world, 3);
        EXPECT_EQ(resumed.world.state_hash(), one.world.state_hash());
    }
}

TEST(MeetingBodies, that_pile_up_stay_apart) {
    Pile pile(implicit());
    take_steps(pile.world, 60);
    EXPECT_LT(pile.world.energy().balance_error, 0.01);
    for (std::size_t i = 0; i < pile.bodies.size(); ++i) {
        EXPECT_TRUE(all_finite(pile.world, pile.bodies[i]));
        EXPECT_NEAR(pile.world.report(pile.bodies[i]).volume / pile.world.report(pile.bodies[i]).rest_volume, 1, 0.1);
        for (std::size_t j = i + 1; j < pile.bodies.size(); ++j)
            EXPECT_GT(norm(center_of_mass(pile.world, pile.bodies[i]) - center_of_mass(pile.world, pile.bodies[j])),
                      0.05);
    }
}

TEST(MeetingBodies, that_begin_inside_of_each_other_pass_through_and_it_is_said) {
    World world(implicit({.gravity = {}}));
    const BodyId one = world.add_body(cube_mesh, small_body());
    world.add_body(cube_mesh, small_body({.translation = {0.05, 0, 0}}));
    world.add_body(cube_mesh, small_body({.translation = {0.1501, 0, 0}}));
    const std::vector<Warning> warnings = world.warnings();
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings.front().message.find("body 1 begins 0.05 m inside of body 0"), std::string::npos)
        << warnings.front().message;
    take_steps(world, 3);
    EXPECT_LT(world.energy().kinetic, 1e-12);
    world.remove_body(one);
    take_steps(world, 3);
    EXPECT_LT(world.energy().kinetic, 1e-12);
}

TEST(MeetingBodies, pass_through_each_other_in_explicit_steps_and_it_is_said) {
    World world({.integrator = Integrator::leap_frog});
    world.add_body(cube_mesh, small_body());
    EXPECT_TRUE(world.warnings().empty());
    world.add_body(cube_mesh, small_body({.translation = {0, 0.2, 0}}));
    ASSERT_EQ(world.warnings().size(), 1u);
    EXPECT_NE(world.warnings().front().message.find("implicit-euler"), std::string::npos);
}

}  // namespace
}  // namespace phyxel
