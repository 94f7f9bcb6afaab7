/// The ways in which implicit steps and equilibria may be found.
#include <gtest/gtest.h>

#include <cmath>

#include "phyxel/error.h"
#include "world/brunet_beam.h"
#include "world/motion.h"

namespace phyxel {
namespace {

/// Where the tip of a bar is that was let go from the level, after some steps.
Vec3 swung_tip(const SolverSettings& solver, int steps = 10) {
    World world({.time_step = 1.0 / 60, .integrator = Integrator::implicit_euler, .solver = solver});
    BodySettings settings = small_body();
    settings.material.law = Law::corotated;
    const BodyId body = world.add_body(make_box({0.3, 0.05, 0.05}), settings);
    world.add_fix(body, {.box = {{-0.15, -1, -1}, {-0.15, 1, 1}}});
    const std::size_t tip = world.add_probe(body, {0.15, 0, 0});
    for (int k = 0; k < steps; ++k) EXPECT_EQ(world.step().status, StepStatus::ok);
    return world.probe(tip).position;
}

TEST(SolverSettings, of_every_method_tolerance_and_precision_lead_to_the_same_step) {
    const Vec3 exact =
        swung_tip({.method = SolverMethod::newton, .tolerance = 1e-6, .precision = SolverPrecision::full});
    EXPECT_GT(norm(exact - Vec3{0.15, 0, 0}), 0.03);
    const double length = 0.3;
    EXPECT_LT(norm(swung_tip({}) - exact), 3e-3 * length);
    EXPECT_LT(norm(swung_tip({.tolerance = 1e-5}) - exact), 2e-5 * length);
    EXPECT_LT(norm(swung_tip({.precision = SolverPrecision::full}) - exact), 3e-3 * length);
    EXPECT_LT(norm(swung_tip({.method = SolverMethod::newton}) - exact), 3e-3 * length);
}

TEST(SolverSettings, of_one_newton_iteration_miss_the_step) {
    const Vec3 exact = swung_tip({}), once = swung_tip({.method = SolverMethod::single_newton});
    EXPECT_TRUE(is_finite(once));
    EXPECT_GT(norm(once - exact), 0.03 * 0.3);
}

TEST(SolverSettings, with_the_articles_tangent_converge_slowly_in_bending_and_are_told_off_in_stretching) {
    WorldSettings settings;
    settings.solver.tangent = Tangent::brunet_2019;
    Beam down(0.01, bending, {}, settings);
    const StepReport found = down.world.step();
    EXPECT_EQ(found.status, StepStatus::ok) << found.message;
    EXPECT_GE(found.newton_iterations, 9u);
    EXPECT_LE(found.newton_iterations, 16u);
    EXPECT_NEAR(down.displacement().y, bent, 0.008 * std::abs(bent));

    Beam out(0.01, stretching, {}, settings);
    const StepReport lost = out.world.step();
    EXPECT_EQ(lost.status, StepStatus::failed);
    EXPECT_NE(lost.message.find("tangent of Brunet et al. 2019"), std::string::npos) << lost.message;
    EXPECT_LT(norm(out.displacement()), 1e-15);

    World world({.solver = {.tangent = Tangent::brunet_2019}});
    EXPECT_THROW(world.add_body(cube_mesh, small_body()), Error);  // neo-Hookean
}

TEST(SolverSettings, of_a_tolerance_out_of_range_are_refused) {
    for (double tolerance : {-1e-3, 0.6, double(NAN)}) EXPECT_THROW(World({.solver = {.tolerance = tolerance}}), Error);
}

}  // namespace
}  // namespace phyxel
