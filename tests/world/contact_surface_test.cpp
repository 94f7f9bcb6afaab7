/// Bodies with a contact surface that is not the one they show.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/temporary_directory.h"
#include "world/motion.h"
#include "world/parts.h"

namespace phyxel {
namespace {

using test::TemporaryDirectory;

/// The icosahedron with its corners on a sphere, as coarse as an icosphere gets.
TriangleMesh make_icosahedron(double radius) {
    const double phi = (1 + std::sqrt(5.0)) / 2, s = radius / std::sqrt(1 + phi * phi), l = s * phi;
    TriangleMesh mesh;
    mesh.vertices = {{-s, l, 0},  {s, l, 0},  {-s, -l, 0}, {s, -l, 0}, {0, -s, l},  {0, s, l},
                     {0, -s, -l}, {0, s, -l}, {l, 0, -s},  {l, 0, s},  {-l, 0, -s}, {-l, 0, s}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return mesh;
}

/// Two triangles below a cube of 0.1 m, `depth` below its middle.
TriangleMesh make_sole(double depth) {
    return {{{-0.05, -depth, -0.05}, {0.05, -depth, -0.05}, {0.05, -depth, 0.05}, {-0.05, -depth, 0.05}},
            {{0, 1, 2}, {0, 2, 3}},
            {},
            {}};
}

/// The mesh and its copy `apart` from it along x.
TriangleMesh twice(TriangleMesh mesh, double apart) {
    const TriangleMesh one = mesh;
    const auto count = static_cast<std::uint32_t>(one.vertices.size());
    for (const Vec3& X : one.vertices) mesh.vertices.push_back(X + Vec3{apart, 0, 0});
    for (const Triangle& t : one.triangles) mesh.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    return mesh;
}

/// A box of eight corners.
TriangleMesh make_crate(double length, double width) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            {(i & 1 ? 0.5 : -0.5) * length, (i & 2 ? 0.5 : -0.5) * width, (i & 4 ? 0.5 : -0.5) * width});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

TEST(ContactSurface, lets_a_fine_sphere_rest_on_the_flat_side_of_a_coarse_one) {
    constexpr double R = 0.1;
    const double flat = R * std::sqrt((5 + 2 * std::sqrt(5.0)) / 15);  // from the middle to a side
    for (Integrator integrator : {Integrator::implicit_euler, Integrator::leap_frog}) {
        World world({.integrator = integrator, .mass_damping = 20});
        // The side of normal (1, 1, 1) down.
        BodySettings settings = small_body(
            {.rotation = {{1, 0, -1}, std::acos(-1 / std::sqrt(3.0)) * 180 / M_PI}, .translation = {0, flat, 0}});
        settings.material.youngs_modulus = 1e6;
        settings.contact_mesh = make_icosahedron(R);
        const BodyId ball = world.add_body(make_sphere(R), settings);
        EXPECT_TRUE(world.warnings().empty());
        world.add_collider(Plane{});
        take_steps(world, integrator == Integrator::implicit_euler ? 60 : 30);
        EXPECT_LT(world.energy().kinetic, 1e-6);
        EXPECT_NEAR(center_of_mass(world, ball).y, flat, 0.01 * R);
        EXPECT_NEAR(norm(center_of_mass(world, ball) - Vec3{0, flat, 0}), 0, 0.01 * R);
    }
}

TEST(ContactSurface, larger_than_its_body_stops_others_where_it_is) {
    constexpr double margin = 0.01;
    World world;
    BodySettings settings = small_body({.translation = {0, 0.05 + margin, 0}});
    settings.material.youngs_modulus = 1e6;
    settings.contact_mesh = make_box({0.1 + 2 * margin, 0.1 + 2 * margin, 0.1 + 2 * margin});
    const BodyId low = world.add_body(cube_mesh, settings);
    settings.translation.y += 0.1 + 2 * margin;
    const BodyId high = world.add_body(cube_mesh, settings);
    world.add_collider(Plane{});
    EXPECT_TRUE(world.warnings().empty());  // they begin side by side
    take_steps(world, 60);
    EXPECT_NEAR(center_of_mass(world, low).y, 0.05 + margin, 0.03 * margin + 1e-4);
    EXPECT_NEAR(center_of_mass(world, high).y - center_of_mass(world, low).y, 0.1 + 2 * margin, 0.1 * margin);
    EXPECT_GT(world.step().contacts, 0u);
}

// A surface two spacings below its body: its points lie outside of the box around the nodes that carry
// them.
TEST(ContactSurface, far_outside_of_its_body_is_felt_from_where_it_is) {
    BodySettings settings = small_body({.translation = {0, 0.13, 0}, .velocity = {0, -1, 0}});
    settings.material.youngs_modulus = 1e6;
    const double margin = 0.05;
    settings.contact_mesh = make_box({0.09, 0.1 + 2 * margin, 0.09});
    World world({.time_step = 1e-3, .gravity = {}});
    const BodyId body = world.add_body(cube_mesh, settings);
    world.add_collider(Plane{});
    for (int step = 0; step < 60 && world.step().contacts == 0; ++step) {
    }
    // One step of 1 mm at most is the first contact deep.
    EXPECT_NEAR(center_of_mass(world, body).y, 0.05 + margin, 2e-3);
}

TEST(ContactSurface, equal_to_the_mesh_changes_no_bit) {
    const auto hash = [](bool given, Integrator integrator) {
        World world({.integrator = integrator, .threads = 2});
        for (int i = 0; i < 2; ++i) {
            BodySettings settings = small_body({.scale = 0.5,
                                                .rotation = {{1, 2, 3}, 20},
                                                .translation = {0.02 * i, 0.03 + 0.075 * i, 0},
                                                .velocity = {0, -1, 0}});
            const TriangleMesh mesh = make_torus(0.14, 0.06);
            if (given) settings.contact_mesh = mesh;
            world.add_body(mesh, settings);
        }
        world.add_collider(Plane{.point = {0, -0.03, 0}});
        take_steps(world, 4);
        EXPECT_GT(world.step().contacts, 0u);
        return world.state_hash();
    };
    for (Integrator integrator : {Integrator::implicit_euler, Integrator::verlet})
        EXPECT_EQ(hash(true, integrator), hash(false, integrator));
}

TEST(ContactSurface, has_no_point_where_only_dropped_triangles_or_none_have_a_corner) {
    TriangleMesh mesh = cube_mesh;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{0, -0.07, 0}, {0, -0.08, 0}});
    mesh.triangles.push_back({first, first, 0});
    World world({.gravity = {}});
    world.add_body(mesh, small_body());
    world.add_collider(Plane{.point = {0, -0.06, 0}});
    EXPECT_EQ(world.step().contacts, 0u);
}

TEST(ContactSurface, is_made_when_something_can_touch_and_when_changes_no_bit) {
    for (Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::leap_frog}) {
        const auto begin = [&] {
            World world({.integrator = integrator, .threads = 2});
            world.add_body(cube_mesh, small_body({.rotation = {{1, 2, 3}, 20}, .velocity = {0.1, -1, 0}}));
            return world;
        };
        const Plane floor{.point = {0, -0.14, 0}};
        World early = begin(), late = begin();
        early.add_collider(floor);
        take_steps(early, 2);
        take_steps(late, 2);
        EXPECT_FALSE(late.parts().bodies[0]->contact.has_value());
        const TemporaryDirectory folder;
        early.save_checkpoint(folder / "checkpoint");
        late.add_collider(floor);
        std::size_t touched = 0;
        for (int k = 0; k < 6; ++k) {
            take_steps(early, 1);
            touched += late.step().contacts;
        }
        EXPECT_GT(touched, 0u);
        EXPECT_EQ(early.state_hash(), late.state_hash());

        World resumed = begin();
        resumed.add_collider(floor);
        resumed.load_checkpoint(folder / "checkpoint");
        take_steps(resumed, 6);
        EXPECT_EQ(resumed.state_hash(), early.state_hash());
    }
}

TEST(ContactSurface, of_a_lone_body_is_made_when_another_comes) {
    for (Integrator integrator : {Integrator::implicit_euler, Integrator::leap_frog}) {
        const bool meet = integrator == Integrator::implicit_euler;
        World world({.gravity = {}, .integrator = integrator});
        world.add_body(cube_mesh, small_body());
        take_steps(world, 1);
        EXPECT_FALSE(world.parts().bodies[0]->contact.has_value());
        const BodyId other =
            world.add_body(cube_mesh, small_body({.translation = {0, 0.11, 0}, .velocity = {0, -1, 0}}));
        EXPECT_EQ(world.parts().bodies[0]->contact.has_value(), meet);
        take_steps(world, 2);
        EXPECT_EQ(world.step().contacts > 0, meet);
        world.remove_body(other);
        take_steps(world, 1);
    }
}

TEST(ContactSurface, that_is_open_holds_the_body_off_obstacles_and_out_of_others) {
    // Turned up or down, it is the same.
    for (const bool turned : {false, true}) {
        TriangleMesh sole = make_sole(0.06);
        if (turned)
            for (Triangle& t : sole.triangles) std::swap(t[0], t[1]);
        World world;
        BodySettings settings = small_body({.translation = {0, 0.06, 0}});
        settings.contact_mesh = sole;
        settings.material.youngs_modulus = 1e6;
        settings.name = "shoe";
        const BodyId shoe = world.add_body(cube_mesh, settings);
        world.add_collider(Plane{});
        settings.contact_mesh.reset();
        settings.name = "ground";
        settings.translation = {0.5, 0.05, 0};
        const BodyId ground = world.add_body(cube_mesh, settings);
        settings.contact_mesh = sole;
        settings.translation = {0.5, 0.16, 0};
        settings.name = "boot";
        const BodyId boot = world.add_body(cube_mesh, settings);
        const auto warnings = world.warnings();
        ASSERT_EQ(warnings.size(), 2u);
        EXPECT_NE(warnings[0].message.find("\"boot\" is not closed"), std::string::npos) << warnings[0].message;
        EXPECT_NE(warnings[1].message.find("\"shoe\" is not closed"), std::string::npos) << warnings[1].message;
        take_steps(world, 40);
        EXPECT_NEAR(center_of_mass(world, shoe).y, 0.06, 5e-4);
        EXPECT_NEAR(center_of_mass(world, boot).y - center_of_mass(world, ground).y, 0.11, 1e-3);
    }
}

TEST(ContactSurface, goes_with_the_part_of_the_body_that_is_nearest) {
    // A cuff around one of two bars a quarter spacing apart, almost half way to the other.
    World world({.gravity = {}});
    BodySettings settings = small_body({.spacing = 0.01});
    settings.contact_mesh = make_box({0.022, 0.1, 0.022});
    const BodyId body = world.add_body(twice(make_box({0.02, 0.1, 0.02}), 0.0225), settings);
    world.add_fix(body, {.box = {{-1, -1, -1}, {0.011, 1, 1}}});
    world.add_fix(body, {.box = {{0.0115, -1, -1}, {1, 1, 1}}, .path = {{0, {}}, {1, {0, 0, 0.2}}}});
    world.add_collider(Plane{.point = {0, 0, 0.05}, .normal = {0, 0, -1}});
    const StepReport report = world.advance(0.5);
    EXPECT_EQ(report.status, StepStatus::ok) << report.message;
    EXPECT_EQ(report.contacts, 0u);
}

std::string refusal(const TriangleMesh& contact) {
    World world;
    BodySettings settings = small_body({.scale = 0.001, .translation = {0, 1, 0}});
    settings.contact_mesh = contact;
    try {
        world.add_body(make_box({100, 100, 100}), settings);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(ContactSurface, that_cannot_work_is_refused_with_the_place_and_the_remedy) {
    const auto expect = [](const TriangleMesh& contact, std::initializer_list<const char*> words) {
        const std::string message = refusal(contact);
        for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << message << "\n" << word;
    };
    expect({}, {"body contact_mesh", "no triangle"});
    TriangleMesh box = make_crate(100, 100);
    box.source = "cover.obj";
    const TriangleMesh good = box;
    EXPECT_EQ(refusal(good), "");
    box.vertices[3].y = std::numeric_limits<double>::quiet_NaN();
    expect(box, {"body contact_mesh: cover.obj", "vertex 3", "not a finite number"});
    box = good;
    box.triangles[2][1] = 77;
    expect(box, {"cover.obj", "triangle 2, vertex 77", "only 8 vertices"});
    box = good;
    box.triangles = {{0, 0, 1}};
    expect(box, {"cover.obj", "no triangle", "has any area"});
    // One corner is far off; and it keeps its number although others at its place come before it.
    box = good;
    box.vertices.insert(box.vertices.begin(), good.vertices[0]);
    for (Triangle& t : box.triangles)
        for (std::uint32_t& v : t) ++v;
    box.triangles.push_back({0, 2, 3});
    box.vertices[8] *= 5;
    expect(box, {"cover.obj", "vertex 8 at [", "0.346", "m away from the body", "less than 0.055 m outside",
                 "scale, rotation and translation of the body act on both"});
    // In another unit: told by its vertices, before it is cut into triangles of the size of the lattice.
    expect(make_box({1e9, 1e9, 1e9}), {"vertex", "away from the body"});
    // An open triangle on the body is accepted.
    TriangleMesh bow = {{{-50, -50, 50}, {50, -50, 50}, {0, 50, 50}}, {{0, 1, 2}}, {}, {}};
    EXPECT_EQ(refusal(bow), "");
}

TEST(ContactSurface, between_two_legs_is_refused_where_it_bridges_the_gap) {
    const TriangleMesh legs = twice(make_box({0.05, 0.05, 0.05}), 0.3);
    BodySettings settings = small_body();
    settings.contact_mesh = make_crate(1, 0.05);
    World world;
    try {
        world.add_body(legs, settings);
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("vertex"), std::string::npos) << error.what();
    }
    for (Vec3& X : settings.contact_mesh->vertices) X.x = X.x < 0 ? -0.025 : 0.325;  // from end to end
    try {
        world.add_body(legs, settings);
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("contact_mesh: the surface at [0.15, "), std::string::npos)
            << error.what();
    }
}

TEST(ContactSurface, is_part_of_what_a_checkpoint_is_of) {
    const auto make = [](double side) {
        World world;
        BodySettings settings = small_body({.translation = {0, 0.055, 0}, .velocity = {0, -1, 0.2}});
        if (side > 0) settings.contact_mesh = make_box({side, side, side});
        world.add_body(cube_mesh, settings);
        settings.translation = {0, 0.17, 0.02};
        world.add_body(cube_mesh, settings);
        world.add_collider(Plane{});
        return world;
    };
    const TemporaryDirectory folder;
    World world = make(0.11);
    take_steps(world, 4);
    world.save_checkpoint(folder / "checkpoint");
    take_steps(world, 3);
    World resumed = make(0.11);
    resumed.load_checkpoint(folder / "checkpoint");
    take_steps(resumed, 3);
    EXPECT_EQ(resumed.state_hash(), world.state_hash());
    for (const double side : {0.0, 0.108}) {
        World other = make(side);
        EXPECT_THROW(other.load_checkpoint(folder / "checkpoint"), Error) << side;
    }
}

}  // namespace
}  // namespace phyxel
