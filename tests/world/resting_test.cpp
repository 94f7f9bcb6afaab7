/// Bodies that meet colliders, and where the energy goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "world/motion.h"

namespace phyxel {
namespace {

double lowest(const World& world, BodyId body) {
    const auto x = world.surface(body).positions();
    return std::min_element(x.begin(), x.end(), [](const Vec3f& a, const Vec3f& b) { return a.y < b.y; })->y;
}

TEST(Resting, box_of_twelve_triangles_lies_flat_on_the_floor_and_hardly_sinks_in) {
    // Inside of its two large triangles a face has points that touch, too: it does not sag between its corners.
    World world(
        {.time_step = 1.0 / 60, .integrator = Integrator::leap_frog, .mass_damping = 40, .stiffness_damping = 5e-4});
    BodySettings settings = small_body({.translation = {0, 0.025, 0}});
    settings.material.youngs_modulus = 2e5;  // what it sinks in falls with the square of the stable step
    const BodyId box = world.add_body(make_box({0.2, 0.05, 0.2}), settings);
    world.add_collider(Plane{});
    const std::size_t below = world.add_probe(box, {0, 0, 0}), corner = world.add_probe(box, {0.1, 0, 0.1});
    const StepReport report = world.advance(0.4);
    EXPECT_EQ(report.status, StepStatus::ok);
    EXPECT_GT(report.contacts, 100u);
    EXPECT_LT(world.energy().kinetic, 1e-8);
    EXPECT_GT(lowest(world, box), -0.01 * 0.025);
    EXPECT_GT(world.probe(below).position.y, -0.01 * 0.025);
    EXPECT_NEAR(world.probe(below).position.y, world.probe(corner).position.y, 0.01 * 0.025);
}

TEST(Resting, ball_balances_on_a_sphere_and_on_a_turned_box) {
    const auto settle = [](auto collider) {
        World world({.time_step = 1.0 / 60, .integrator = Integrator::leap_frog, .mass_damping = 20});
        BodySettings settings = small_body({.translation = {0, 0.11, 0}});
        const BodyId ball = world.add_body(make_sphere(0.1), settings);
        world.add_collider(collider);
        const StepReport report = world.advance(0.6);
        EXPECT_EQ(report.status, StepStatus::ok) << report.message;
        EXPECT_GT(report.contacts, 0u);
        EXPECT_NEAR(mean_velocity(world, ball).y, 0, 0.01 * 0.44);  // it came at 0.44 m/s
        EXPECT_LT(world.energy().balance_error, 0.01);
        const Vec3 at = center_of_mass(world, ball);
        EXPECT_GT(at.y, 0.08);
        EXPECT_LT(at.y, 0.1);
        EXPECT_NEAR(at.x, 0, 5e-3);
        // Nothing is left inside of the collider.
        EXPECT_GT(lowest(world, ball), -0.02);
    };
    settle(Sphere{.center = {0, -0.5, 0}, .radius = 0.5});
    settle(Box{.center = {0, -0.1, 0}, .size = {1, 0.2, 1}, .rotation = {{0, 1, 0}, 30}});
}

TEST(Resting, ball_without_friction_slides_off_a_tilted_box) {
    // A plate thinner than a spacing would not stop it: contact gives way by a fraction of one, and beyond its middle a
    // box pushes out on the other side.
    World world({.time_step = 1.0 / 60, .integrator = Integrator::leap_frog});
    const BodyId ball = world.add_body(make_sphere(0.1), small_body({.translation = {0, 0.25, 0}}));
    world.add_collider(Box{.size = {2, 0.2, 2}, .rotation = {{0, 0, 1}, -20}, .friction = 0});
    world.advance(0.4);
    EXPECT_GT(mean_velocity(world, ball).x, 0.5);
    EXPECT_NEAR(world.energy().friction, 0, 1e-12);
}

TEST(Energy, balances_to_a_per_cent_with_damping_friction_loads_and_moving_grips) {
    World world(
        {.time_step = 1.0 / 60, .integrator = Integrator::leap_frog, .mass_damping = 0.5, .stiffness_damping = 1e-3});
    const TriangleMesh cube = make_box({0.1, 0.1, 0.1});
    const BodyId dropped =
        world.add_body(make_sphere(0.1), small_body({.translation = {0, 0.15, 0}, .velocity = {1, 0, 0}}));
    const BodyId pulled = world.add_body(cube, small_body({.translation = {1, 1, 0}}));
    const BodyId pushed = world.add_body(cube, small_body({.translation = {2, 0.06, 0}}));
    world.add_collider(Plane{.friction = 0.3});
    const BoxSelection top{{-5, 1.05, -5}, {5, 1.05, 5}};
    world.add_fix(pulled, {.box = top, .path = {{0, {}, 0}, {0.2, {0.1, 0.1, 0}, 0}, {0.4, {0, 0, 0}, 0}}});
    world.add_load(pushed, {.box = {{1, 0.109, -1}, {3, 0.12, 1}}, .force = Vec3{2, 0, 0}, .ramp = 0.1});
    world.add_load(pushed, {.box = {{2.04, -1, -1}, {3, 1, 1}}, .pressure = 300});
    for (int k = 0; k < 30; ++k) {
        const StepReport report = world.step();
        ASSERT_EQ(report.status, StepStatus::ok) << report.message;
        ASSERT_EQ(report.retries, 0u);
        EXPECT_LT(world.energy().balance_error, 0.01) << world.time();
    }
    const EnergyLedger e = world.energy();
    EXPECT_GT(e.damping, 0);
    EXPECT_GT(e.friction, 0);
    EXPECT_GT(std::abs(e.external_work), 0.01);
    EXPECT_EQ(world.report(dropped).fragments, 1u);
}

TEST(Energy, stays_balanced_when_gravity_velocity_and_material_change_between_steps) {
    World world({.integrator = Integrator::leap_frog});
    const BodyId ball = world.add_body(make_sphere(0.1), small_body({.translation = {0, 0.11, 0}}));
    world.add_collider(Plane{});
    const auto run = [&] {
        EXPECT_EQ(world.advance(0.1).status, StepStatus::ok);
        EXPECT_LT(world.energy().balance_error, 0.01) << world.time();
    };
    run();
    world.set_gravity({1, -3, 0});
    EXPECT_LT(world.energy().balance_error, 0.01);
    run();
    world.set_velocity(ball, {0, -1, 0.5});
    EXPECT_EQ(world.velocities(ball)[0], (Vec3{0, -1, 0.5}));
    run();
    const double before = world.stable_substep();
    Material stiffer = small_body().material;
    stiffer.youngs_modulus *= 4;
    world.set_material(ball, stiffer);
    EXPECT_NEAR(world.stable_substep(), 0.5 * before, 0.1 * before);
    run();
}

TEST(BodyReport, has_a_mass_of_density_times_the_volume_of_the_mesh) {
    for (const TriangleMesh& mesh : {make_box({0.1, 0.2, 0.3}), make_sphere(0.1), make_torus(0.2, 0.08)})
        for (Quadrature quadrature : {Quadrature::grid, Quadrature::nodes}) {
            World world;
            BodySettings settings;
            settings.count = 150;
            settings.scale = 2;
            settings.quadrature = quadrature;
            settings.lattice_rotation = {{1, 2, 3}, 40};
            settings.material = {.density = 700, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
            const BodyId body = world.add_body(mesh, settings);
            const BodyReport r = world.report(body);
            EXPECT_NEAR(r.mesh_volume, 8 * check_mesh(mesh).volume, 1e-12 * r.mesh_volume);
            EXPECT_NEAR(r.rest_volume, r.mesh_volume, 1e-11 * r.mesh_volume);
            EXPECT_NEAR(r.volume, r.mesh_volume, 1e-11 * r.mesh_volume);
            EXPECT_NEAR(r.mass, 700 * r.mesh_volume, 1e-11 * r.mass);
            EXPECT_NEAR(static_cast<double>(r.nodes), 150, 30);
        }
}

TEST(WorldSurface, keeps_the_callers_vertices_and_the_two_sides_of_a_seam_together) {
    // Every triangle with corners of its own, as exported with a texture seam along each edge.
    const TriangleMesh closed = make_torus(0.2, 0.08);
    TriangleMesh split;
    for (const Triangle& t : closed.triangles) {
        const auto first = static_cast<std::uint32_t>(split.vertices.size());
        for (std::uint32_t v : t) split.vertices.push_back(closed.vertices[v]);
        split.triangles.push_back({first, first + 1, first + 2});
    }
    World world;
    BodySettings settings = small_body({.translation = {0, 0.1, 0}, .count = 150});
    settings.spacing = 0;
    const BodyId body = world.add_body(split, settings);
    world.add_collider(Plane{});
    EXPECT_EQ(world.advance(0.2).status, StepStatus::ok);
    EXPECT_EQ(world.mesh_report(body).duplicate_vertices, split.vertices.size() - closed.vertices.size());
    const Surface& surface = world.surface(body);
    ASSERT_EQ(surface.positions().size(), split.vertices.size());
    EXPECT_EQ(surface.triangles().size(), split.triangles.size());
    std::vector<Vec3f> at(closed.vertices.size()), normal(closed.vertices.size());
    for (std::size_t t = 0; t < closed.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t own = split.triangles[t][c], shared = closed.triangles[t][c];
            if (at[shared] == Vec3f{}) at[shared] = surface.positions()[own], normal[shared] = surface.normals()[own];
            EXPECT_EQ(surface.positions()[own], at[shared]);
            EXPECT_EQ(surface.normals()[own], normal[shared]);
        }
}

TEST(WorldSurface, of_a_mesh_that_was_inside_out_is_the_mended_one) {
    TriangleMesh inward = make_sphere(0.1);
    for (Triangle& t : inward.triangles) std::swap(t[1], t[2]);
    World world;
    const BodyId body = world.add_body(inward, small_body());
    EXPECT_TRUE(world.mesh_report(body).inside_out);
    EXPECT_FALSE(world.warnings().empty());
    const Surface& surface = world.surface(body);
    for (std::size_t v = 0; v < surface.positions().size(); ++v)
        EXPECT_GT(dot(surface.positions()[v], surface.normals()[v]), 0);
}

}  // namespace
}  // namespace phyxel
