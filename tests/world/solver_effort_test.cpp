/// What implicit steps cost in iterations, on the beam of 0.1 x 0.1 x 1 m that falls from straight under its weight,
/// held at one end (`phyxel bench cantilever`), solved to one per cent of each step.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "phyxel/phyxel.h"
#include "support/measured.h"

namespace phyxel {
namespace {

/// Mean over the first sixty steps; the beam is `cells` spacings across.
double iterations_a_step(int cells, double youngs_modulus) {
    constexpr int steps = 60;
    World world({.time_step = 1.0 / 60,
                 .integrator = Integrator::implicit_euler,
                 .mass_damping = 4,
                 .solver = {.tolerance = 1e-2}});
    BodySettings settings;
    settings.spacing = 0.1 / cells;
    settings.translation = {0.05, 0.05, 0.5};
    settings.material = corotated({.density = 1000, .youngs_modulus = youngs_modulus, .poissons_ratio = 0.3});
    const BodyId body = world.add_body(make_box({0.1, 0.1, 1}), settings);
    world.add_fix(body, {.box = {{-1, -1, -1e-9}, {1, 1, 1e-9}}});
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
        const StepReport report = world.step();
        EXPECT_EQ(report.status, StepStatus::ok) << report.message;
        sum += double(report.newton_iterations);
    }
    std::ostringstream name;
    name << world.positions(body).size() << " nodes, " << youngs_modulus << " Pa";
    measured(name.str(), sum / steps);
    return sum / steps;
}

// 2.1, 3.0, 2.8, 1.7 and 1.2 from 1e5 to 1e9 Pa.
TEST(SolverEffort, of_a_thousand_nodes_is_four_iterations_and_hardly_depends_on_stiffness) {
    double least = 1e9, most = 0;
    for (double youngs_modulus : {1e5, 1e6, 1e9}) {
        const double iterations = iterations_a_step(4, youngs_modulus);
        least = std::min(least, iterations), most = std::max(most, iterations);
    }
    EXPECT_LE(most, 4);
    EXPECT_LE(most - least, 2);
}

TEST(SolverEffort, LONG_of_4500_nodes_is_four_iterations) { EXPECT_LE(iterations_a_step(7, 1e6), 4); }
TEST(SolverEffort, LONG_of_32000_nodes_is_six_iterations) { EXPECT_LE(iterations_a_step(14, 1e6), 6); }

}  // namespace
}  // namespace phyxel
