/// Implicit steps: what they keep, how they damp, and that any step and any state is survived.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "support/temporary_directory.h"
#include "world/hanging_cube.h"
#include "world/motion.h"
#include "world/parts.h"

namespace phyxel {
namespace {

constexpr Integrator schemes[] = {Integrator::implicit_euler, Integrator::bdf2};

TEST(ImplicitStep, of_a_falling_body_is_that_of_its_scheme) {
    for (Integrator scheme : schemes) {
        const double dt = 1.0 / 60;
        World world({.time_step = dt, .integrator = scheme});
        const BodyId body = world.add_body(make_sphere(0.1), small_body());
        for (int k = 0; k < 10; ++k) ASSERT_EQ(world.step().status, StepStatus::ok);
        EXPECT_NEAR(mean_velocity(world, body).y, -g * 10 * dt, 1e-4);  // the steps are solved to 3e-3 each
        // Backward Euler: g dt^2 n (n + 1)/2; two steps back: less.
        const double fallen = -center_of_mass(world, body).y;
        if (scheme == Integrator::implicit_euler) EXPECT_NEAR(fallen, g * dt * dt * 55, 1e-3 * g * dt * dt * 55);
        else EXPECT_NEAR(fallen, 0.5 * g * 100 * dt * dt, 0.02 * g * 100 * dt * dt);
        EXPECT_LT(world.energy().balance_error, 1e-3);
    }
}

TEST(ImplicitStep, books_all_energy_and_dissipates_some_itself) {
    for (Integrator scheme : schemes) {
        World world({.time_step = 1.0 / 60, .integrator = scheme, .mass_damping = 0.5});
        const BodyId body = world.add_body(make_box({0.4, 0.1, 0.1}), small_body());
        world.add_fix(body, {.box = {{-0.2, -1, -1}, {-0.2, 1, 1}}});
        for (int k = 0; k < 30; ++k) ASSERT_EQ(world.step().status, StepStatus::ok);
        const EnergyLedger e = world.energy();
        EXPECT_GT(e.numerical, 0);
        EXPECT_GT(e.damping, 0);
        EXPECT_LT(e.balance_error, 2e-3);
    }
}

/// Half of the height at which a sine of the given frequency swings, by projection over whole periods.
double amplitude(const std::vector<double>& u, double dt, double omega, double from, double to) {
    double c = 0, s = 0;
    int n = 0;
    for (std::size_t k = 0; k < u.size(); ++k) {
        const double t = static_cast<double>(k + 1) * dt;
        if (t < from || t >= to) continue;
        c += u[k] * std::cos(omega * t), s += u[k] * std::sin(omega * t), ++n;
    }
    return 2 * std::hypot(c, s) / n;
}

/// The tip of a bar that was stretched a little and let go, step by step.
std::vector<double> ringing_bar(Integrator scheme, double dt, int steps) {
    World world({.time_step = dt, .gravity = {}, .integrator = scheme});
    BodySettings settings;
    settings.spacing = 0.05;
    settings.material = corotated({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0});
    const BodyId body = world.add_body(make_box({0.1, 0.1, 1.0}), settings);
    world.add_fix(body, {.box = {{-1, -1, -0.5}, {1, 1, -0.5}}});
    DynamicBody& b = world.parts().body(body);
    for (std::size_t i = 0; i < b.state.x.size(); ++i)
        b.state.x[i].z += 1e-3 * std::sin(0.5 * std::numbers::pi * (b.model.rest[i].z + 0.5));
    const std::size_t tip = world.add_probe(body, {0, 0, 0.5});
    std::vector<double> u;
    for (int k = 0; k < steps; ++k) {
        EXPECT_EQ(world.step().status, StepStatus::ok);
        u.push_back(world.probe(tip).position.z - 0.5);
    }
    return u;
}

TEST(ImplicitStep, of_second_order_rings_at_the_bars_frequency_and_damps_a_tenth_as_much) {
    // Fundamental longitudinal mode of a clamped bar: c/(4 L), c = sqrt(E/rho).
    const double period = 4 / std::sqrt(1e6 / 1000.0), omega = 2 * std::numbers::pi / period;
    const double dt = period / 100;
    const std::vector<double> euler = ringing_bar(Integrator::implicit_euler, dt, 200),
                              bdf2 = ringing_bar(Integrator::bdf2, dt, 200);
    const auto decay = [&](const std::vector<double>& u) {
        const double first = amplitude(u, dt, omega, 0, period), second = amplitude(u, dt, omega, period, 2 * period);
        return 1 - (second * second) / (first * first);  // of the energy, in a period
    };
    EXPECT_GT(decay(euler), 0.3);
    EXPECT_LT(decay(bdf2), 0.1 * decay(euler));
    // Zero crossings of the second order scheme a quarter and three quarters of a period in.
    std::vector<double> crossings;
    for (std::size_t k = 1; k < bdf2.size(); ++k)
        if (bdf2[k - 1] * bdf2[k] < 0)
            crossings.push_back(dt * (static_cast<double>(k) + bdf2[k - 1] / (bdf2[k - 1] - bdf2[k])));
    ASSERT_GE(crossings.size(), 3u);
    EXPECT_NEAR(2 * (crossings[2] - crossings[1]), 2 * (crossings[1] - crossings[0]), 0.01 * period);
    EXPECT_NEAR(crossings[2] - crossings[0], period, 0.01 * period);
}

TEST(ImplicitStep, of_any_stiffness_settles_at_the_same_step) {
    for (double E : {1e5, 1e7, 1e9, 1e11}) {
        HangingCube cube(E, {.time_step = 1.0 / 60, .integrator = Integrator::implicit_euler, .mass_damping = 20});
        for (int k = 0; k < 120; ++k) ASSERT_EQ(cube.world.step().status, StepStatus::ok) << E;
        EXPECT_NEAR(cube.sag(), cube.expected_sag, 0.02 * cube.expected_sag) << E;
    }
}

TEST(ImplicitStep, from_a_scrambled_a_flat_and_an_inverted_state_goes_on_or_says_why_not) {
    for (int kind = 0; kind < 3; ++kind) {
        World world(
            {.time_step = 1.0 / 60, .gravity = {}, .integrator = Integrator::implicit_euler, .mass_damping = 5});
        BodySettings settings = small_body();
        settings.spacing = 0.04;
        const BodyId body = world.add_body(make_box({0.12, 0.12, 0.12}), settings);
        DynamicBody& b = world.parts().body(body);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> anywhere(-0.06, 0.06);
        for (Vec3& x : b.state.x) {
            if (kind == 0) x = {anywhere(random), anywhere(random), anywhere(random)};
            if (kind == 1) x.y = 0;
            if (kind == 2) x.y = -x.y;
        }
        for (int k = 0; k < 60; ++k) {
            const StepReport report = world.step();
            ASSERT_TRUE(all_finite(world, body));
            if (report.status == StepStatus::failed) {
                EXPECT_FALSE(report.message.empty());
                break;
            }
        }
    }
}

TEST(ImplicitStep, holds_a_box_on_a_slope_below_the_friction_angle_and_lets_it_slide_above) {
    const double slope = std::atan(0.3);
    for (double friction : {0.5, 0.1}) {
        World world({.time_step = 1.0 / 60,
                     .gravity = {9.81 * std::sin(slope), -9.81 * std::cos(slope), 0},
                     .integrator = Integrator::implicit_euler});
        BodySettings settings = small_body();
        settings.material.youngs_modulus = 1e6;
        settings.translation = {0, 0.05, 0};
        const BodyId body = world.add_body(make_box({0.2, 0.1, 0.1}), settings);
        world.add_collider(Plane{.friction = friction});
        world.advance(0.5);
        const double begin = center_of_mass(world, body).x;
        world.advance(0.5);
        const double way = center_of_mass(world, body).x - begin;
        if (friction > 0.3) {
            EXPECT_LT(std::abs(way), 1e-4);
        } else {
            // From the speed at 0.5 s on: a (0.5 * 0.5 + 0.125), a = g (sin - mu cos).
            const double a = 9.81 * (std::sin(slope) - friction * std::cos(slope));
            EXPECT_NEAR(way, 0.375 * a, 0.06 * 0.375 * a);
        }
    }
}

TEST(ImplicitStep, gives_the_same_bits_for_any_number_of_threads_and_after_resuming) {
    const test::TemporaryDirectory folder;
    for (Integrator scheme : schemes) {
        const auto make = [&](int threads) {
            World world({.time_step = 1.0 / 60, .integrator = scheme, .threads = threads});
            BodySettings settings = small_body();
            settings.translation = {0, 0.11, 0};
            settings.velocity = {0.5, -1, 0};
            world.add_body(make_sphere(0.1), settings);
            world.add_collider(Plane{});
            return world;
        };
        World whole = make(1);
        whole.advance(0.1);
        whole.save_checkpoint(folder / "state");
        whole.advance(0.1);
        for (int threads : {2, 3, 8}) {
            World other = make(threads);
            other.advance(0.1);
            other.advance(0.1);
            EXPECT_EQ(other.state_hash(), whole.state_hash()) << threads;
        }
        World resumed = make(2);
        resumed.load_checkpoint(folder / "state");
        resumed.advance(0.1);
        EXPECT_EQ(resumed.state_hash(), whole.state_hash());
    }
}

}  // namespace
}  // namespace phyxel
