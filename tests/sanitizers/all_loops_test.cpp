/// A body with more nodes than one chunk of the loops over them, so that threads share every loop, and few steps: quick
/// enough for the thread sanitizer, which the normal test run gives it to.
#include <gtest/gtest.h>

#include "world/motion.h"

namespace phyxel {
namespace {

/// Dropped onto a floor, held at one side and pulled at another, damped.
std::uint64_t hash_after_some_steps(Integrator integrator, BodySettings body, int threads) {
    World world({.gravity = {0, -9.81, 0},
                 .integrator = integrator,
                 .mass_damping = 1,
                 .stiffness_damping = 1e-4,
                 .threads = threads});
    body.translation = {0, 0.5001, 0};
    body.velocity = {0.5, -2, 0};
    const BodyId id = world.add_body(make_box({1, 1, 1}), small_body(body));
    EXPECT_GT(world.masses(id).size(), 1024u);
    world.add_collider(Plane{});
    world.add_fix(id, {.box = {{-1, 0.9, -1}, {1, 2, 1}}});
    world.add_load(id, {.box = {{0.4, 0, -1}, {1, 2, 1}}, .force = Vec3{1, 0, 0}});
    world.add_probe(id, {0, 0.5, 0});
    // Where implicit steps are taken, something stands beside it for it to run against.
    if (!is_explicit(integrator)) world.add_body(cube_mesh, small_body({.translation = {0.56, 0.3, 0}}));
    const StepReport report = world.advance((is_explicit(integrator) ? 6 : 1) * world.stable_substep());
    EXPECT_EQ(report.status, StepStatus::ok) << report.message;
    EXPECT_GT(report.contacts, 0u);
    EXPECT_TRUE(all_finite(world, id));
    world.energy();
    return world.state_hash();
}

TEST(AllLoops, give_the_same_bits_with_one_thread_and_with_three) {
    const BodySettings grid = {.spacing = 0.095},
                       nodes = {.spacing = 0.12, .lattice = Lattice::bcc, .quadrature = Quadrature::nodes};
    EXPECT_EQ(hash_after_some_steps(Integrator::leap_frog, grid, 1),
              hash_after_some_steps(Integrator::leap_frog, grid, 3));
    EXPECT_EQ(hash_after_some_steps(Integrator::verlet, nodes, 1), hash_after_some_steps(Integrator::verlet, nodes, 3));
    EXPECT_EQ(hash_after_some_steps(Integrator::implicit_euler, grid, 1),
              hash_after_some_steps(Integrator::implicit_euler, grid, 3));
}

}  // namespace
}  // namespace phyxel
