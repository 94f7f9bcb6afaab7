/// Fixes, grips and probes: where they take a body, and with which force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "world/motion.h"

namespace phyxel {
namespace {

constexpr Vec3 bar_sides{0.2, 0.05, 0.05};
constexpr BoxSelection left{{-0.1, -1, -1}, {-0.1, 1, 1}}, right{{0.1, -1, -1}, {0.1, 1, 1}};
const TriangleMesh bar_mesh = make_box(bar_sides);

BodySettings bar(const AxisAngle& lattice = {}) {
    BodySettings settings = small_body();
    settings.lattice_rotation = lattice;
    return settings;
}

/// The lattice with the bar, where fixes hold nodes, and turned against it, where they hold averages of patches.
constexpr AxisAngle lattices[] = {{{0, 0, 1}, 0}, {{1, 2, 3}, 40}};

TEST(Grip, takes_what_it_holds_to_its_keyframes_exactly) {
    World world({.time_step = 0.01, .gravity = {}, .integrator = Integrator::leap_frog, .mass_damping = 20});
    const BodyId body = world.add_body(bar_mesh, bar());
    world.add_fix(body, {.box = left});
    const Vec3 center{0.1, 0, 0}, up{0, 0.02, 0};
    world.add_fix(body, {.box = right,
                         .axis = {2, 0, 0},
                         .center = center,
                         .path = {{0.02, {}, 0}, {0.07, up, 30}, {0.1, {0.01, 0, 0}, -15}}});
    const auto expect_at = [&](const Vec3& displacement, double degrees) {
        const Mat3 R = rotation_about({1, 0, 0}, degrees * std::numbers::pi / 180);
        for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
            const Vec3 X = world.rest_positions(body)[i], x = world.positions(body)[i];
            if (X.x > 0.1 - 1e-9) {
                EXPECT_LT(norm(x - (R * (X - center) + center + displacement)), 1e-10);
            } else if (X.x < -0.1 + 1e-9) {
                EXPECT_LT(norm(x - X), 1e-10);
            }
        }
    };
    world.advance(0.02);
    expect_at({}, 0);
    world.advance(0.025);
    expect_at(0.5 * up, 15);
    world.advance(0.025);
    expect_at(up, 30);
    world.advance(0.03);
    expect_at({0.01, 0, 0}, -15);
    world.advance(0.05);
    expect_at({0.01, 0, 0}, -15);
    EXPECT_LT(world.energy().balance_error, 0.01);
}

TEST(Grip, takes_the_average_of_each_patch_along_where_no_node_lies_on_the_surface) {
    World world({.time_step = 0.01, .gravity = {}, .integrator = Integrator::leap_frog, .mass_damping = 20});
    const BodyId body = world.add_body(bar_mesh, bar(lattices[1]));
    const Vec3 way{0.01, 0.02, 0};
    world.add_fix(body, {.box = left});
    world.add_fix(body, {.box = right, .path = {{0, {}, 0}, {0.05, way, 0}}});
    const std::size_t middle = world.add_probe(body, {0.1, 0, 0});
    world.advance(0.3);
    // Averages of cells' patches are held, a single point of the face is not.
    EXPECT_LT(norm(world.probe(middle).position - world.probe(middle).rest - way), 0.03 * norm(way));
    EXPECT_LT(world.energy().balance_error, 0.01);
}

TEST(Reaction, of_what_holds_a_hanging_body_is_its_weight) {
    for (const AxisAngle& lattice : lattices) {
        World world({.time_step = 0.05, .integrator = Integrator::leap_frog, .mass_damping = 60});
        const BodyId body = world.add_body(bar_mesh, bar(lattice));
        const std::size_t fix = world.add_fix(body, {.box = {{-1, 0.025, -1}, {1, 0.025, 1}}});
        world.advance(0.6);
        const double weight = world.report(body).mass * g;
        const Reaction r = world.reaction(fix);
        EXPECT_NEAR(r.force.y, weight, 1e-3 * weight);
        EXPECT_NEAR(r.force.x, 0, 1e-3 * weight);
        EXPECT_LT(norm(r.torque), 1e-3 * weight * bar_sides.x);
    }
}

TEST(Reaction, of_a_cantilever_is_its_load_and_load_times_arm) {
    for (const AxisAngle& lattice : lattices) {
        World world({.time_step = 0.05, .gravity = {}, .integrator = Integrator::leap_frog, .mass_damping = 20});
        const BodyId body = world.add_body(bar_mesh, bar(lattice));
        const std::size_t fix = world.add_fix(body, {.box = left});
        const double load = 0.02;  // [N]; bends by a thousandth of the length
        world.add_load(body, {.box = right, .force = Vec3{0, -load, 0}});
        const std::size_t tip = world.add_probe(body, {0.1, 0, 0});
        world.advance(1.5);
        const Reaction r = world.reaction(fix);
        EXPECT_NEAR(r.force.y, load, 1e-3 * load);
        const double arm = world.probe(tip).position.x - -0.1;
        EXPECT_NEAR(r.torque.z, load * arm, 2e-3 * load * arm);
        EXPECT_LT(std::abs(r.torque.x) + std::abs(r.torque.y), 2e-3 * load * arm);
    }
}

TEST(Rollers, let_a_body_slide_in_the_directions_they_leave_free) {
    World world({.gravity = {0, -g, 0}, .integrator = Integrator::leap_frog});
    const BodyId body = world.add_body(bar_mesh, bar());
    const std::size_t fix = world.add_fix(body, {.box = left, .y = false});
    const Vec3 start = center_of_mass(world, body);
    world.advance(0.1);
    const Vec3 fallen = center_of_mass(world, body) - start;
    EXPECT_NEAR(fallen.y, -0.5 * g * 0.01, 1e-9);
    EXPECT_NEAR(fallen.x, 0, 1e-9);
    EXPECT_NEAR(world.reaction(fix).force.y, 0, 1e-9);
}

TEST(Probe, is_the_material_point_it_was_put_on) {
    World world({.gravity = {}, .integrator = Integrator::leap_frog});
    const BodyId body = world.add_body(bar_mesh, small_body({.translation = {1, 2, 3}, .velocity = {1, 2, 3}}));
    const Vec3 point{1.03, 2.01, 2.98}, corner{1.1, 2.025, 3.025};
    const std::size_t inside = world.add_probe(body, point), edge = world.add_probe(body, corner);
    EXPECT_LT(norm(world.probe(inside).position - point), 1e-12);
    EXPECT_EQ(world.probe(inside).rest, point);
    // Within a millionth of the body's size counts as inside.
    world.add_probe(body, corner + Vec3{1e-7, 0, 0});
    EXPECT_THROW(world.add_probe(body, corner + Vec3{1e-6, 0, 0}), Error);
    world.advance(0.5);
    EXPECT_LT(norm(world.probe(inside).position - (point + 0.5 * Vec3{1, 2, 3})), 1e-11);
    EXPECT_LT(norm(world.probe(edge).position - (corner + 0.5 * Vec3{1, 2, 3})), 1e-11);
}

}  // namespace
}  // namespace phyxel
