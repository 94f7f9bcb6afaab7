/// Thin parts and gaps in the implicit solvers: what does not touch at rest is not tied together, though its nodes lie
/// closer than a support, and is warned about where the lattice hardly resolves it.
#include <gtest/gtest.h>

#include <cmath>

#include "support/measured.h"
#include "world/motion.h"
#include "world/parts.h"

namespace phyxel {
namespace {

constexpr double node_distance = 0.025, gap = node_distance / 4;
constexpr Vec3 plate_sides{0.3, 2 * node_distance, 0.1};

/// Two plates, one above the other, as one body; held at x = 0. The upper one may be pulled up.
struct Plates {
    explicit Plates(const WorldSettings& settings) : world(settings) {
        TriangleMesh mesh = make_box(plate_sides);
        const TriangleMesh upper = make_box(plate_sides);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3& X : upper.vertices) mesh.vertices.push_back(X + Vec3{0, plate_sides.y + gap, 0});
        for (const auto& [i, j, k] : upper.triangles) mesh.triangles.push_back({i + first, j + first, k + first});
        BodySettings made = small_body();
        made.spacing = node_distance;
        made.translation = {0.5 * plate_sides.x, 0, 0};
        body = world.add_body(mesh, made);
        world.add_fix(body, {.box = {{-1, -1, -1}, {1e-6, 1, 1}}});
    }
    /// At the upper plate's end, upwards [N].
    void pull(double force) {
        world.add_load(body, {.box = {{plate_sides.x - 1e-6, 0.5 * plate_sides.y + 0.5 * gap, -1}, {1, 1, 1}},
                              .force = Vec3{0, force, 0}});
    }
    /// Largest displacement of the lower and of the upper plate's nodes [m]. Nodes of the two may lie in one place: it
    /// is the solid in their cells that tells them apart.
    std::array<double, 2> displacements() {
        const Sampling& sampling = world.parts().body(body).model.sampling;
        std::array<double, 2> largest{};
        for (std::size_t i = 0; i < sampling.nodes.size(); ++i) {
            const Vec3 solid = sampling.frame.to_rest(sampling.cell_centroids[sampling.node_cell[i]]);
            double& of_plate = largest[solid.y > 0.5 * plate_sides.y + 0.5 * gap];
            of_plate = std::max(of_plate, norm(world.positions(body)[i] - world.rest_positions(body)[i]));
        }
        return largest;
    }
    World world;
    BodyId body;
};

TEST(ThinParts, a_quarter_spacing_apart_stay_two_in_equilibrium) {
    Plates plates({.time_step = 1, .gravity = {}, .integrator = Integrator::statics});
    plates.pull(0.5);
    const StepReport report = plates.world.step();
    ASSERT_EQ(report.status, StepStatus::ok) << report.message;
    const auto [lower, upper] = plates.displacements();
    EXPECT_GT(upper, gap);
    EXPECT_LE(lower, 1e-12 * upper);
    measured("lower plate [m]", lower);
    measured("upper plate [m]", upper);
}

TEST(ThinParts, a_quarter_spacing_apart_stay_two_in_motion) {
    for (SolverPrecision precision : {SolverPrecision::single, SolverPrecision::full}) {
        Plates plates({.gravity = {}, .integrator = Integrator::implicit_euler, .solver = {.precision = precision}});
        plates.pull(0.5);
        for (int k = 0; k < 20; ++k) ASSERT_EQ(plates.world.step().status, StepStatus::ok);
        const auto [lower, upper] = plates.displacements();
        EXPECT_GT(upper, gap);
        EXPECT_LE(lower, (precision == SolverPrecision::full ? 1e-12 : 1e-6) * upper);
        measured("lower plate in motion [m]", lower);
    }
}

/// The warnings of a world with a plate of the given thickness, all in one.
std::string warnings_of_plate(double thickness) {
    World world({.integrator = Integrator::implicit_euler});
    BodySettings settings = small_body();
    settings.spacing = node_distance;
    world.add_body(make_box({0.2, thickness, 0.2}), settings);
    std::string all;
    for (const Warning& warning : world.warnings()) all += warning.message + "\n";
    return all;
}

TEST(ThinParts, of_one_spacing_are_warned_about) {
    for (double thickness : {1.5 * node_distance, node_distance, 0.9 * node_distance})
        EXPECT_NE(warnings_of_plate(thickness), "") << thickness;
    EXPECT_NE(
        warnings_of_plate(0.8 * node_distance).find("less than one spacing: a spacing of 0.01 m would resolve it"),
        std::string::npos);
    EXPECT_EQ(warnings_of_plate(2.1 * node_distance), "");
}

}  // namespace
}  // namespace phyxel
