/// The same bits for any number of threads, after a resume, and in whatever company: on a small version of the demo, a
/// bunny of jelly that falls onto a floor.
#include <gtest/gtest.h>

#include <thread>

#include "geometry/clipping_shapes.h"
#include "support/temporary_directory.h"
#include "world/motion.h"

namespace phyxel {
namespace {

using test::TemporaryDirectory;

constexpr int short_run = 5;  ///< steps; the bunny touches the floor in the fourth

const TriangleMesh& bunny_mesh() {
    static const TriangleMesh mesh = bunny();
    return mesh;
}

BodySettings jelly_bunny(const Vec3& velocity = {0, -1, 0}) {
    BodySettings settings;
    settings.scale = 0.01;
    settings.translation = {0, 0.05, 0};
    settings.velocity = velocity;
    settings.count = 200;
    settings.material = {.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.45};
    return settings;
}

/// The demo with few nodes.
struct Demo {
    explicit Demo(WorldSettings settings = {}, const BodySettings& body = jelly_bunny())
        : world(with_damping(settings)) {
        bunny = world.add_body(bunny_mesh(), body);
        world.add_collider(Plane{});
    }
    static WorldSettings with_damping(WorldSettings settings) {
        settings.time_step = 1.0 / 60;
        settings.stiffness_damping = 1e-4;
        return settings;
    }
    std::uint64_t run(int steps) {
        for (int k = 0; k < steps; ++k) {
            const StepReport report = world.step();
            EXPECT_EQ(report.status, StepStatus::ok) << report.message;
            touched = touched || report.contacts > 0;
        }
        return world.state_hash();
    }

    World world;
    BodyId bunny;
    bool touched = false;
};

TEST(StateHash, is_the_same_for_any_number_of_threads) {
    for (Integrator integrator : {Integrator::leap_frog, Integrator::verlet}) {
        Demo one({.integrator = integrator, .threads = 1});
        const std::uint64_t expected = one.run(short_run);
        EXPECT_TRUE(one.touched);
        for (int threads : {2, 3, 8})
            EXPECT_EQ(Demo({.integrator = integrator, .threads = threads}).run(short_run), expected) << threads;
    }
}

TEST(StateHash, is_the_same_in_the_callers_own_task_system) {
    // Two threads, backwards.
    const ParallelFor own = [](std::size_t count, const std::function<void(std::size_t)>& task) {
        const auto every_other = [&](std::size_t first) {
            for (std::size_t k = first; k < count; k += 2) task(count - 1 - k);
        };
        std::thread odd(every_other, 1);
        every_other(0);
        odd.join();
    };
    EXPECT_EQ(Demo({.parallel_for = own}).run(4), Demo({.threads = 1}).run(4));
}

TEST(StateHash, is_another_for_another_velocity) {
    EXPECT_NE(Demo({}, jelly_bunny({0, -1, 0})).run(2), Demo({}, jelly_bunny({0, -1 - 1e-15, 0})).run(2));
}

TEST(StateHash, of_separate_runs_is_that_of_interleaved_ones) {
    Demo first, second({}, jelly_bunny({1, -2, 0}));
    for (int k = 0; k < 3; ++k) first.run(1), second.run(1);
    EXPECT_EQ(first.world.state_hash(), Demo().run(3));
    EXPECT_EQ(second.world.state_hash(), Demo({}, jelly_bunny({1, -2, 0})).run(3));
}

TEST(Resume, gives_the_bits_of_a_run_that_never_stopped) {
    const TemporaryDirectory folder;
    Demo whole;
    whole.run(3);
    whole.world.save_checkpoint(folder / "state");
    const std::uint64_t at_save = whole.world.state_hash();
    const std::uint64_t expected = whole.run(short_run);
    EXPECT_TRUE(whole.touched);

    Demo resumed({.threads = 1});
    resumed.world.load_checkpoint(folder / "state");
    EXPECT_EQ(resumed.world.state_hash(), at_save);
    EXPECT_EQ(resumed.run(short_run), expected);
    EXPECT_EQ(resumed.world.time(), whole.world.time());

    // What is derived goes on as if nothing had been.
    const EnergyLedger a = whole.world.energy(), b = resumed.world.energy();
    EXPECT_EQ(a.damping, b.damping);
    EXPECT_EQ(a.friction, b.friction);
    EXPECT_EQ(a.balance_error, b.balance_error);
    const auto before = whole.world.surface(whole.bunny).positions(),
               after = resumed.world.surface(resumed.bunny).positions();
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin(), after.end()));
}

TEST(Resume, goes_back_in_time_in_the_same_world) {
    const TemporaryDirectory folder;
    Demo demo;
    demo.run(3);
    demo.world.save_checkpoint(folder / "state");
    const std::uint64_t expected = demo.run(4);
    demo.world.load_checkpoint(folder / "state");
    EXPECT_EQ(demo.run(4), expected);
}

TEST(Resume, is_refused_with_the_checkpoint_of_another_world) {
    const TemporaryDirectory folder;
    Demo().world.save_checkpoint(folder / "state");
    const auto expect_refusal = [&](Demo& other, const char* what) {
        const std::uint64_t before = other.world.state_hash();
        try {
            other.world.load_checkpoint(folder / "state");
            ADD_FAILURE() << what << ": loaded";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("of another world"), std::string::npos) << error.what();
        }
        EXPECT_EQ(other.world.state_hash(), before) << what;
    };
    BodySettings settings = jelly_bunny();
    settings.material.youngs_modulus = 3e4;
    Demo stiffer({}, settings);
    expect_refusal(stiffer, "another modulus");
    settings = jelly_bunny();
    settings.lattice_offset = {0.1, 0, 0};
    Demo shifted({}, settings);
    expect_refusal(shifted, "another lattice");
    Demo heavier({.gravity = {0, -20, 0}});
    expect_refusal(heavier, "another gravity");
    Demo with_sphere;
    with_sphere.world.add_collider(Sphere{.radius = 0.01});
    expect_refusal(with_sphere, "another collider");
    Demo two;
    two.world.add_body(make_sphere(0.1), small_body());
    expect_refusal(two, "another body");
    Demo held;
    held.world.add_fix(held.bunny, {.box = {{-1, 0.1, -1}, {1, 1, 1}}});
    expect_refusal(held, "another fix");
    Demo lifted({}, [] {
        BodySettings s = jelly_bunny();
        s.translation.y += 1e-3;
        return s;
    }());
    expect_refusal(lifted, "another place");
    World other_friction({.time_step = 1.0 / 60, .stiffness_damping = 1e-4});
    other_friction.add_body(bunny_mesh(), jelly_bunny());
    other_friction.add_collider(Plane{.friction = 0.1});
    EXPECT_THROW(other_friction.load_checkpoint(folder / "state"), Error) << "another friction";
}

TEST(Resume, keeps_the_changes_made_between_steps) {
    const TemporaryDirectory folder;
    const auto change = [](Demo& demo) {
        demo.world.set_gravity({1, -5, 0});
        Material stiffer = jelly_bunny().material;
        stiffer.youngs_modulus *= 2;
        demo.world.set_material(demo.bunny, stiffer);
    };
    Demo whole;
    whole.run(3);
    change(whole);
    whole.run(2);
    whole.world.save_checkpoint(folder / "state");
    const std::uint64_t expected = whole.run(3);
    Demo resumed;
    change(resumed);
    resumed.world.load_checkpoint(folder / "state");
    EXPECT_EQ(resumed.run(3), expected);
}

}  // namespace
}  // namespace phyxel
