/// Whole bodies against closed forms: free fall, a bounce, sliding with friction.
#include <gtest/gtest.h>

#include <cmath>

#include "world/motion.h"

namespace phyxel {
namespace {

const TriangleMesh flat_block = make_box({0.1, 0.05, 0.1});

TEST(FreeFall, covers_half_g_t_squared_to_rounding) {
    for (Integrator integrator : {Integrator::leap_frog, Integrator::verlet}) {
        World world({.time_step = 1.0 / 60, .integrator = integrator});
        const Vec3 v0{0.3, 1.5, -0.2};
        const BodyId cube = world.add_body(make_box({0.1, 0.1, 0.1}), small_body({.velocity = v0}));
        const Vec3 start = center_of_mass(world, cube);
        for (int k = 0; k < 30; ++k) EXPECT_EQ(world.step().status, StepStatus::ok);
        const double t = world.time();
        EXPECT_NEAR(t, 0.5, 1e-14);
        const Vec3 way = center_of_mass(world, cube) - start - t * v0;
        EXPECT_NEAR(way.y, -0.5 * g * t * t, 1e-12);
        EXPECT_NEAR(way.x, 0, 1e-12);
        EXPECT_NEAR(way.z, 0, 1e-12);
        const EnergyLedger energy = world.energy();
        EXPECT_LT(energy.elastic, 1e-20);
        EXPECT_LT(energy.balance_error, 1e-12);
    }
}

TEST(Bounce, of_an_elastic_body_returns_to_the_height_it_fell_from) {
    // Quasi-static: the contact lasts long against the body's own periods, since the sphere meets the floor in a
    // point. What is lost, 0.5 %, goes into vibration.
    World world({.time_step = 1.0 / 240, .integrator = Integrator::leap_frog});
    BodySettings settings = small_body({.translation = {0, 0.11, 0}});
    settings.material.youngs_modulus = 2e5;
    settings.spacing = 0.025;
    const BodyId ball = world.add_body(make_sphere(0.1), settings);
    world.add_collider(Plane{});
    const double fall = center_of_mass(world, ball).y - 0.1;
    double highest = 0;
    bool touched = false;
    for (int k = 0; k < 120; ++k) {
        const StepReport report = world.step();
        ASSERT_EQ(report.status, StepStatus::ok) << report.message;
        touched = touched || report.contacts > 0;
        if (touched) highest = std::max(highest, center_of_mass(world, ball).y - 0.1);
    }
    const EnergyLedger e = world.energy();
    EXPECT_NEAR(highest, fall, 0.01 * fall);
    EXPECT_LT(e.balance_error, 0.01);
}

TEST(Sliding, stops_after_v_squared_over_two_mu_g) {
    for (double mu : {0.2, 0.5}) {
        World world({.time_step = 1.0 / 60, .integrator = Integrator::leap_frog, .stiffness_damping = 5e-3});
        const double v0 = 1;
        const BodyId block =
            world.add_body(flat_block, small_body({.translation = {0, 0.025, 0}, .velocity = {v0, 0, 0}}));
        world.add_collider(Plane{.friction = mu});
        const double start = center_of_mass(world, block).x;
        const StepReport report = world.advance(v0 / (mu * g) + 0.2);
        ASSERT_EQ(report.status, StepStatus::ok) << report.message;
        const double way = center_of_mass(world, block).x - start, expected = v0 * v0 / (2 * mu * g);
        const EnergyLedger e = world.energy();
        EXPECT_NEAR(way, expected, 0.01 * expected);
        EXPECT_LT(std::abs(mean_velocity(world, block).x), 1e-3 * v0);
        EXPECT_LT(e.balance_error, 0.01);
    }
}

/// A block on a slope, as gravity sees it; it starts with a velocity down the slope.
struct Slope {
    explicit Slope(double tangent, double velocity)
        : angle(std::atan(tangent)),
          world({.time_step = 1.0 / 60, .gravity = gravity(), .stiffness_damping = 3e-3}),
          block(world.add_body(flat_block, small_body({.translation = {0, 0.025, 0}, .velocity = {velocity, 0, 0}}))) {
        world.add_collider(Plane{.friction = mu});
        world.advance(0.2);  // vibrations of the start
    }
    Vec3 gravity() const { return {g * std::sin(angle), -g * std::cos(angle), 0}; }

    static constexpr double mu = 0.5;
    double angle;
    World world;
    BodyId block;
};

TEST(Slope, below_the_friction_angle_holds_a_block_without_creep) {
    for (double tangent : {0.3, 0.48}) {
        Slope slope(tangent, 0);
        const Vec3 start = center_of_mass(slope.world, slope.block);
        slope.world.advance(0.25);
        const double crept = norm(center_of_mass(slope.world, slope.block) - start);
        EXPECT_LT(crept, 1e-5) << tangent;
    }
}

TEST(Slope, beyond_the_friction_angle_gives_g_sine_less_mu_cosine) {
    for (double tangent : {0.52, 0.8}) {
        Slope slope(tangent, 0.5);
        const double v0 = mean_velocity(slope.world, slope.block).x, t0 = slope.world.time();
        slope.world.advance(0.2);
        const double acceleration = (mean_velocity(slope.world, slope.block).x - v0) / (slope.world.time() - t0);
        const double expected = g * (std::sin(slope.angle) - slope.mu * std::cos(slope.angle));
        EXPECT_NEAR(acceleration, expected, 0.01 * expected) << tangent;
    }
}

}  // namespace
}  // namespace phyxel
