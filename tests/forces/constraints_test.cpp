#include "forces/constraints.h"

#include <gtest/gtest.h>

#include <cstring>

#include "forces/loaded_box.h"
#include "model/modelled.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

constexpr BoxSelection left_face = {{-1, -1, -1}, {-0.499, 1, 1}};

Model box_model(const BodySettings& settings, double spacing = 0.2) {
    return modelled(make_box(sides), settings, spacing);
}

/// Velocities after the projection of random ones.
struct Projected {
    std::vector<Vec3> before, after, impulse;
};

Projected project(Constraints& constraints, std::span<const Vec3> x, double time = 0, double dt = 0) {
    Projected p;
    p.before = p.after = random_field(x.size(), 1, 4);
    p.impulse.resize(x.size());
    constraints.start_measuring();
    constraints.project(time, dt, x, p.after, p.impulse);
    return p;
}

/// Nodes that a projection pushed, ascending.
std::vector<std::uint32_t> held_nodes(const Projected& p) {
    std::vector<std::uint32_t> held;
    for (std::uint32_t i = 0; i < p.impulse.size(); ++i)
        if (p.impulse[i] != Vec3{}) held.push_back(i);
    return held;
}

/// Area-weighted mean over the left face of the field with coefficients `u`.
Vec3 mean_over_face(const Model& m, std::span<const Vec3> u) {
    const SurfaceSelection face = select_surface(m, make_box(sides), left_face);
    const EmbeddedPoints points = embed(m.sampling, m.approximation, face.position, face.cell, Gradients::no, threads);
    Vec3 mean;
    for (std::size_t s = 0; s < points.size(); ++s)
        mean += norm(face.area[s]) / face.total_area * points.position(s, u);
    return mean;
}

TEST(Constraints, face_on_a_node_plane_holds_its_nodes_and_no_others) {
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.lattice != Lattice::cubic) continue;
        const Model m = box_model(settings_of(scheme));
        Constraints constraints;
        constraints.add(m, make_box(sides), {.box = left_face}, threads);
        std::vector<std::uint32_t> on_face;
        for (std::uint32_t i = 0; i < m.rest.size(); ++i)
            if (std::abs(m.rest[i].x + 0.5) < 1e-9) on_face.push_back(i);
        EXPECT_EQ(on_face.size(), 5u * 4) << scheme.name;
        const Projected p = project(constraints, m.rest);
        EXPECT_EQ(held_nodes(p), on_face) << scheme.name;
        for (std::uint32_t i : on_face) EXPECT_LE(norm(p.after[i]), 1e-8) << scheme.name;
    }
}

TEST(Constraints, face_on_no_node_plane_holds_the_mean_of_its_patches) {
    for (const Scheme& scheme : all_schemes())
        for (const bool aligned : {true, false}) {
            if (aligned && scheme.lattice == Lattice::cubic) continue;
            const Model m = box_model(aligned ? settings_of(scheme) : turned(settings_of(scheme)));
            Constraints constraints;
            constraints.add(m, make_box(sides), {.box = left_face}, threads);
            const Projected p = project(constraints, m.rest);
            EXPECT_GT(norm(mean_over_face(m, p.before)), 1e-2) << scheme.name;
            EXPECT_LE(norm(mean_over_face(m, p.after)), 1e-6) << scheme.name;
            double moving = 0;  // no node is nailed: the patches are means of several
            for (const Vec3& v : p.after) moving += norm(v) > 0;
            EXPECT_EQ(moving, static_cast<double>(p.after.size())) << scheme.name;
        }
}

TEST(Constraints, rollers_leave_the_other_directions_free) {
    for (const bool aligned : {true, false}) {
        const BodySettings settings = settings_of(all_schemes()[0]);
        const Model m = box_model(aligned ? settings : turned(settings));
        Constraints constraints;
        constraints.add(m, make_box(sides), {.box = left_face, .x = true, .y = false, .z = false}, threads);
        const Projected p = project(constraints, m.rest);
        double change = 0;
        for (std::size_t i = 0; i < p.after.size(); ++i) {
            EXPECT_EQ(p.after[i].y, p.before[i].y);
            EXPECT_EQ(p.after[i].z, p.before[i].z);
            change = std::max(change, std::abs(p.after[i].x - p.before[i].x));
        }
        EXPECT_GT(change, 0.1);
    }
}

TEST(Constraints, projection_is_the_smallest_change_that_holds) {
    // M (v' - v) = C^T lambda, and v' holds: the change is at right angles, in the metric of the masses, to v'.
    for (const bool aligned : {true, false}) {
        const BodySettings settings = settings_of(all_schemes()[0]);
        const Model m = box_model(aligned ? settings : turned(settings));
        Constraints constraints;
        const std::size_t fix = constraints.add(m, make_box(sides), {.box = left_face}, threads);
        const Projected p = project(constraints, m.rest);
        Vec3 momentum, exchanged;
        double product = 0, before = 0;
        for (std::size_t i = 0; i < p.after.size(); ++i) {
            const Vec3 change = p.after[i] - p.before[i];
            EXPECT_LE(norm(m.mass[i] * change - p.impulse[i]), 1e-12 * m.total_mass);
            momentum += m.mass[i] * change;
            exchanged += p.impulse[i];
            product += m.mass[i] * dot(change, p.after[i]);
            before += m.mass[i] * norm_squared(p.before[i]);
        }
        // The shift that keeps the factor of nearly dependent patches alive leaves them open by as much.
        EXPECT_LE(std::abs(product), (aligned ? 1e-8 : 1e-5) * before);
        EXPECT_LE(norm(momentum - constraints.reaction(fix, 1).force), 1e-12 * m.total_mass);
        EXPECT_LE(norm(momentum - exchanged), 1e-12 * m.total_mass);
    }
}

TEST(Constraints, moving_grip_carries_the_face_along_its_path) {
    const Fix fix = {.box = left_face,
                     .axis = {1, 0, 0},
                     .center = {-0.5, 0, 0},
                     .path = {{0, {}, 0}, {2, {0.2, 0, 0}, 40}, {3, {0.2, 0, 0.1}, 40}}};
    const GripMotion motion(fix);
    const auto expect_at = [&](double time, const Vec3& expected) {
        EXPECT_LE(norm(motion.place({-0.5, 0.3, 0}, time) - expected), 1e-15) << time;
    };
    const double c20 = std::cos(std::acos(-1) / 9), s20 = std::sin(std::acos(-1) / 9);
    const double c40 = std::cos(std::acos(-1) / 4.5), s40 = std::sin(std::acos(-1) / 4.5);
    expect_at(-1, {-0.5, 0.3, 0});
    expect_at(1, {-0.4, 0.3 * c20, 0.3 * s20});
    expect_at(2.5, {-0.3, 0.3 * c40, 0.3 * s40 + 0.05});
    expect_at(9, {-0.3, 0.3 * c40, 0.3 * s40 + 0.1});

    for (const bool aligned : {true, false}) {
        const BodySettings settings = settings_of(all_schemes()[0]);
        const Model m = box_model(aligned ? settings : turned(settings));
        Constraints constraints;
        constraints.add(m, make_box(sides), fix, threads);
        const double dt = 1e-3;
        double time = 1;
        std::vector<Vec3> x;
        for (const Vec3& X : m.rest) x.push_back(motion.place(X, time));
        std::vector<std::uint32_t> held;
        // What the shift leaves open of nearly dependent patches, the next steps close.
        for (int step = 0; step < 6; ++step) {
            time += dt;
            const Projected p = project(constraints, x, time, dt);
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * p.after[i];
            held = held_nodes(p);
            const double error = norm(mean_over_face(m, x) - motion.place({-0.5, 0, 0}, time));
            if (!aligned) {
                EXPECT_LE(error, 1e-5);
            }
        }
        for (std::uint32_t i : held)
            if (aligned) {
                EXPECT_LE(norm(x[i] - motion.place(m.rest[i], time)), 1e-8) << i;
            }
    }
}

TEST(Constraints, overlapping_fixes_hold_together) {
    const Model m = box_model(settings_of(all_schemes()[0]));
    Constraints constraints;
    constraints.add(m, make_box(sides), {.box = left_face}, threads);
    constraints.add(m, make_box(sides), {.box = left_face}, threads);
    const Projected p = project(constraints, m.rest);
    for (std::uint32_t i : held_nodes(p)) EXPECT_LE(norm(p.after[i]), 1e-7);
    for (const Vec3& v : p.after) EXPECT_TRUE(is_finite(v));
}

}  // namespace
}  // namespace phyxel
