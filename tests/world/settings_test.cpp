/// What a caller gets wrong is thrown at once, by the name of the field.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "world/motion.h"

namespace phyxel {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

template <class Task>
void expect_error(const std::string& field, Task&& task) {
    try {
        task();
        ADD_FAILURE() << field << ": accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
}

void expect_world_refused(const std::string& field, const WorldSettings& settings) {
    expect_error(field, [&] { World world(settings); });
}

template <class Change>
void expect_body_refused(const std::string& field, Change&& change) {
    World world;
    BodySettings settings = small_body();
    change(settings);
    expect_error(field, [&] { world.add_body(cube_mesh, settings); });
    EXPECT_EQ(world.step().status, StepStatus::ok);  // nothing was left half-made
}

TEST(WorldSettings, that_are_wrong_are_refused_by_name) {
    for (double bad : {0.0, -1.0, nan, infinity}) expect_world_refused("time_step", {.time_step = bad});
    expect_world_refused("gravity", {.gravity = {0, nan, 0}});
    for (double bad : {-1.0, nan, infinity}) expect_world_refused("mass_damping", {.mass_damping = bad});
    for (double bad : {-1.0, nan, infinity}) expect_world_refused("stiffness_damping", {.stiffness_damping = bad});
    for (int bad : {-1, 100000}) expect_world_refused("threads", {.threads = bad});
}

TEST(BodySettings, that_are_wrong_are_refused_by_name) {
    for (double bad : {0.0, -1.0, nan, infinity}) {
        expect_body_refused("scale", [&](BodySettings& s) { s.scale = bad; });
        expect_body_refused("density", [&](BodySettings& s) { s.material.density = bad; });
        expect_body_refused("youngs_modulus", [&](BodySettings& s) { s.material.youngs_modulus = bad; });
    }
    for (double bad : {-1.0, 0.5, 0.7, nan})
        expect_body_refused("poissons_ratio", [&](BodySettings& s) { s.material.poissons_ratio = bad; });
    for (double bad : {-0.01, nan, infinity}) expect_body_refused("spacing", [&](BodySettings& s) { s.spacing = bad; });
    expect_body_refused("count", [](BodySettings& s) { s.spacing = 0, s.count = 3; });
    expect_body_refused("spacing", [](BodySettings& s) { s.spacing = 1e9; });
    expect_body_refused("spacing", [](BodySettings& s) { s.spacing = 1e-7; });
    expect_body_refused("rotation.axis", [](BodySettings& s) { s.rotation = {{0, 0, 0}, 1}; });
    expect_body_refused("rotation.degrees", [](BodySettings& s) { s.rotation = {{0, 0, 1}, nan}; });
    expect_body_refused("sampling.rotation.axis", [](BodySettings& s) { s.lattice_rotation = {{0, 0, 0}, 1}; });
    expect_body_refused("sampling.offset", [](BodySettings& s) { s.lattice_offset = {nan, 0, 0}; });
    expect_body_refused("translation", [](BodySettings& s) { s.translation = {0, infinity, 0}; });
    expect_body_refused("velocity", [](BodySettings& s) { s.velocity = {0, nan, 0}; });
    expect_body_refused("velocity", [](BodySettings& s) { s.velocity = {1e9, 0, 0}; });
    expect_body_refused("kernel.support", [](BodySettings& s) { s.kernel.support = 1; });
    expect_body_refused("kernel.neighbors", [](BodySettings& s) { s.kernel.neighbors = 3; });
    expect_body_refused("kernel.dilation", [](BodySettings& s) { s.kernel.neighbors = 20, s.kernel.dilation = 1; });
    expect_body_refused("stabilization", [](BodySettings& s) { s.stabilization = nan; });
}

TEST(WorldCalls, that_are_wrong_are_refused_by_name) {
    World world;
    const BodyId body = world.add_body(cube_mesh, small_body());
    const BoxSelection all{{-1, -1, -1}, {1, 1, 1}}, none{{2, 2, 2}, {3, 3, 3}}, upside_down{{1, 1, 1}, {-1, -1, -1}};
    expect_error("fix box", [&] { world.add_fix(body, {.box = upside_down}); });
    expect_error("selects nothing", [&] { world.add_fix(body, {.box = none}); });
    expect_error("fix directions", [&] { world.add_fix(body, {.box = all, .x = false, .y = false, .z = false}); });
    expect_error("fix axis", [&] { world.add_fix(body, {.box = all, .axis = {0, 0, 0}}); });
    expect_error("fix center", [&] { world.add_fix(body, {.box = all, .center = {0, nan, 0}}); });
    expect_error("fix path", [&] { world.add_fix(body, {.box = all, .path = {{1, {}, 0}, {1, {}, 0}}}); });
    expect_error("fix path", [&] { world.add_fix(body, {.box = all, .path = {{0, {nan, 0, 0}, 0}}}); });
    expect_error("fix path", [&] { world.add_fix(body, {.box = all, .path = {{nan, {}, 0}}}); });
    expect_error("load box", [&] { world.add_load(body, {.box = upside_down, .pressure = 1}); });
    expect_error("exactly one of", [&] { world.add_load(body, {.box = all}); });
    expect_error("exactly one of", [&] { world.add_load(body, {.box = all, .force = Vec3{}, .pressure = 1}); });
    expect_error("load force", [&] { world.add_load(body, {.box = all, .force = Vec3{nan, 0, 0}}); });
    expect_error("load traction", [&] { world.add_load(body, {.box = all, .traction = Vec3{0, infinity, 0}}); });
    expect_error("load pressure", [&] { world.add_load(body, {.box = all, .pressure = nan}); });
    expect_error("load ramp", [&] { world.add_load(body, {.box = all, .pressure = 1, .ramp = -1}); });
    expect_error("load ramp", [&] { world.add_load(body, {.box = all, .pressure = 1, .ramp = infinity}); });
    expect_error("probe", [&] { world.add_probe(body, {0.2, 0, 0}); });
    expect_error("probe", [&] { world.add_probe(body, {nan, 0, 0}); });
    expect_error("friction", [&] { world.add_collider(Plane{.friction = -1}); });
    expect_error("gravity", [&] { world.set_gravity({nan, 0, 0}); });
    expect_error("velocity", [&] { world.set_velocity(body, {0, infinity, 0}); });
    expect_error("density",
                 [&] { world.set_material(body, {.density = 999, .youngs_modulus = 1e5, .poissons_ratio = 0.3}); });
    expect_error("youngs_modulus",
                 [&] { world.set_material(body, {.density = 1000, .youngs_modulus = -1, .poissons_ratio = 0.3}); });
    const StepReport report = world.step();
    EXPECT_EQ(report.status, StepStatus::ok);
    EXPECT_EQ(report.contacts, 0u);
}

TEST(BodyIds, of_removed_bodies_are_never_taken_for_others) {
    World world;
    const BodyId first = world.add_body(cube_mesh, small_body());
    const BodyId second = world.add_body(cube_mesh, small_body({.translation = {1, 0, 0}}));
    world.remove_body(first);
    expect_error("no longer", [&] { world.positions(first); });
    expect_error("no longer", [&] { world.remove_body(first); });
    EXPECT_GT(world.positions(second)[0].x, 0.9);
    const BodyId third = world.add_body(cube_mesh, small_body({.translation = {2, 0, 0}}));
    EXPECT_NE(third, first);
    expect_error("no longer", [&] { world.positions(first); });
    EXPECT_GT(world.positions(third)[0].x, 1.9);
    EXPECT_GT(world.positions(second)[0].x, 0.9);
    expect_error("no probe", [&] { (void)world.probe(7); });
    expect_error("no fix", [&] { (void)world.reaction(7); });
    EXPECT_EQ(world.step().status, StepStatus::ok);
}

}  // namespace
}  // namespace phyxel
