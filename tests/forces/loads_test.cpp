#include "forces/loads.h"

#include <gtest/gtest.h>

#include "forces/loaded_box.h"
#include "model/modelled.h"
#include "phyxel/error.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

constexpr BoxSelection right_face = {{0.499, -1, -1}, {1, 1, 1}};
/// A rectangle of the right face: y from -0.1 to 0.3, z from 0 to 0.2, which cuts triangles and cells.
constexpr BoxSelection patch = {{0.499, -0.1, 0}, {1, 0.3, 0.2}};
constexpr double patch_area = 0.4 * 0.2;
constexpr Vec3 patch_center = {0.5, 0.1, 0.1};

/// Boxes on all schemes, aligned and turned.
template <class Check>
void for_all_boxes(Check&& check) {
    for (const Scheme& scheme : all_schemes())
        for (const bool aligned : {true, false}) {
            const BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
            check(scheme.name + (aligned ? ", aligned" : ", turned"),
                  modelled(make_box(sides), settings, equal_spacing(scheme, 0.2)));
        }
}

std::vector<Vec3> load_forces(const Model& m, const TriangleMesh& mesh, const Load& load, std::span<const Vec3> x,
                              double time = 0) {
    std::vector<Vec3> f(m.rest.size());
    SurfaceLoad(m, mesh, load, threads).add(time, x, f);
    return f;
}

Vec3 total(std::span<const Vec3> f) {
    Vec3 sum;
    for (const Vec3& force : f) sum += force;
    return sum;
}

Vec3 torque_about_origin(std::span<const Vec3> x, std::span<const Vec3> f) {
    Vec3 sum;
    for (std::size_t i = 0; i < f.size(); ++i) sum += cross(x[i], f[i]);
    return sum;
}

TEST(Loads, force_and_torque_of_a_loaded_patch_are_exact) {
    const Vec3 force = {3, -12, 5};
    double worst = 0;
    for_all_boxes([&](const std::string& name, const Model& m) {
        const auto f = load_forces(m, make_box(sides), {.box = patch, .force = force}, m.rest);
        const double force_error = norm(total(f) - force) / norm(force);
        const double torque_error = norm(torque_about_origin(m.rest, f) - cross(patch_center, force)) / norm(force);
        EXPECT_LE(force_error, 1e-13) << name;
        EXPECT_LE(torque_error, 1e-8) << name;  // the selection widens its box by 1e-9 of the body
        worst = std::max(worst, torque_error);
    });
    measured("torque", worst);
}

TEST(Loads, traction_is_force_over_area) {
    const Vec3 traction = {30, -12, 50};
    for_all_boxes([&](const std::string& name, const Model& m) {
        const auto by_traction = load_forces(m, make_box(sides), {.box = patch, .traction = traction}, m.rest);
        const auto by_force = load_forces(m, make_box(sides), {.box = patch, .force = patch_area * traction}, m.rest);
        EXPECT_LE(largest_difference(by_traction, by_force), 1e-7 * largest(by_force)) << name;
    });
}

TEST(Loads, dead_loads_do_not_follow_the_body) {
    for_all_boxes([&](const std::string& name, const Model& m) {
        const Load load = {.box = patch, .force = Vec3{1, 2, 3}};
        EXPECT_TRUE(load_forces(m, make_box(sides), load, m.rest) ==
                    load_forces(m, make_box(sides), load, turned_stretched_and_shaken(m)))
            << name;
    });
}

TEST(Loads, pressure_on_a_face_pushes_inward_by_its_area) {
    for_all_boxes([&](const std::string& name, const Model& m) {
        const auto f = load_forces(m, make_box(sides), {.box = right_face, .pressure = 100}, m.rest);
        EXPECT_LE(norm(total(f) - Vec3{-100 * sides.y * sides.z, 0, 0}), 1e-10) << name;
    });
}

TEST(Loads, pressure_all_around_has_no_net_force_or_torque) {
    double worst = 0, worst_stretched = 0;
    for_all_boxes([&](const std::string& name, const Model& m) {
        const Load load = {.box = everything, .pressure = 100};
        for (const Mat3& F : {Mat3::identity(), some_rotation(), some_rotation() * some_stretch()}) {
            const auto x = affine(m, F, {1, 2, 3}), f = load_forces(m, make_box(sides), load, x);
            EXPECT_LE(net_force(f), 1e-13) << name;
            EXPECT_LE(net_torque(x, f), 1e-13) << name;
            worst = std::max({worst, net_force(f), net_torque(x, f)});
        }
        // Where F varies, one point a piece no longer integrates cof(F) N exactly.
        const auto x = turned_stretched_and_shaken(m);
        worst_stretched = std::max(worst_stretched, net_force(load_forces(m, make_box(sides), load, x)));
    });
    EXPECT_LE(worst_stretched, 0.02);
    measured("affine", worst);
    measured("shaken", worst_stretched);
}

TEST(Loads, pressure_turns_with_the_body) {
    const Mat3 Q = rotation_about(normalized(Vec3{-1, 1, 3}), 2.0);
    for_all_boxes([&](const std::string& name, const Model& m) {
        const Load load = {.box = patch, .pressure = 100};
        std::vector<Vec3> x = turned_stretched_and_shaken(m), f = load_forces(m, make_box(sides), load, x);
        for (Vec3& p : x) p = Q * p + Vec3{1, 2, 3};
        for (Vec3& force : f) force = Q * force;
        EXPECT_LE(largest_difference(load_forces(m, make_box(sides), load, x), f), 1e-12 * largest(f)) << name;
    });
}

TEST(Loads, ramp_grows_linearly_and_stays) {
    const Model m = modelled(make_box(sides), settings_of(all_schemes()[0]), 0.2);
    const Load load = {.box = right_face, .force = Vec3{8, 0, 0}, .ramp = 2};
    const auto at = [&](double time) { return total(load_forces(m, make_box(sides), load, m.rest, time)).x; };
    EXPECT_NEAR(at(0), 0, 1e-14);
    EXPECT_NEAR(at(0.5), 2, 1e-13);
    EXPECT_NEAR(at(2), 8, 1e-13);
    EXPECT_NEAR(at(7), 8, 1e-13);
}

TEST(Loads, box_that_selects_nothing_is_refused_with_the_extent_of_the_surface) {
    const Model m = modelled(make_box(sides), settings_of(all_schemes()[0]), 0.2);
    try {
        SurfaceLoad(m, make_box(sides), {.box = {{2, 2, 2}, {3, 3, 3}}, .force = Vec3{1, 0, 0}}, threads);
        FAIL() << "an empty selection was accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("selects nothing"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("[0.5, 0.4, 0.3]"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace phyxel
