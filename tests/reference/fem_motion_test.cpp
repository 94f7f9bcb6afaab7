#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "reference/fem/solve.h"
#include "support/measured.h"

namespace phyxel::fem {
namespace {

std::vector<Vec3> displacement(const Solid& solid, const State& state) {
    std::vector<Vec3> u = state.x;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] -= solid.mesh.X[i];
    return u;
}

const Material soft = {.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3, .law = Law::corotated};

TEST(FemMotion, free_fall_is_that_of_the_implicit_step) {
    for (const ElementType type : {ElementType::tetrahedra, ElementType::hexahedra_8, ElementType::hexahedra_27}) {
        const Solid solid(box_mesh(type, {2, 2, 2}, {0.1, 0.1, 0.1}), soft);
        Conditions conditions(solid);
        add_gravity(conditions, solid, {0, -9.81, 0});
        System system(solid, conditions);
        State state = at_rest(solid);
        const double dt = 1.0 / 60, damping = 4;
        double v = 0, u = 0;
        for (int step = 0; step < 5; ++step) {
            ASSERT_TRUE(step_implicit_euler(system, state, dt, damping).converged);
            v = (v - dt * 9.81) / (1 + dt * damping);
            u += dt * v;
        }
        for (const Vec3& velocity : state.v) EXPECT_LT(norm(velocity - Vec3{0, v, 0}), 1e-9);
        for (const Vec3& moved : displacement(solid, state)) EXPECT_LT(norm(moved - Vec3{0, u, 0}), 1e-9);
        EXPECT_NEAR(kinetic_energy(system, state), 0.5 * v * v, 1e-9);  // of 1 kg
    }
}

TEST(FemMotion, small_vibration_follows_the_discrete_formula_of_its_mode) {
    const Solid solid(box_mesh(ElementType::hexahedra_8, {1, 1, 3}, {0.1, 0.1, 0.3}), soft);
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    System system(solid, conditions);
    const Eigen::MatrixXd K(system.stiffness(solid.mesh.X)), M(system.mass());  // the solver reads lower halves alone
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);

    // (q'' - q')/dt^2 - (q' - q)/dt^2 + damping (q'' - q')/dt + omega^2 q'' = 0 along the lowest mode.
    const Eigen::VectorXd mode = modes.eigenvectors().col(0);
    const double omega_squared = modes.eigenvalues()[0], dt = 0.2 / std::sqrt(omega_squared), damping = 1;
    double q = 1e-7, rate = 0;
    State state = at_rest(solid);
    system.add(q * mode, state.x);
    for (int step = 0; step < 20; ++step) {
        ASSERT_TRUE(step_implicit_euler(system, state, dt, damping).converged);
        rate = (rate - dt * omega_squared * q) / (1 + dt * damping + dt * dt * omega_squared);
        q += dt * rate;
    }
    const Eigen::VectorXd u = system.gather(displacement(solid, state));
    EXPECT_LT((u - q * mode).norm(), 1e-4 * 1e-7 * mode.norm());
}

TEST(FemMotion, damped_motion_comes_to_rest_where_statics_says) {
    const Solid solid(box_mesh(ElementType::hexahedra_8, {1, 1, 4}, {0.1, 0.1, 0.4}), soft);
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    add_gravity(conditions, solid, {0, -9.81, 0});
    System system(solid, conditions);
    State state = at_rest(solid);
    for (int step = 0; step < 200; ++step) ASSERT_TRUE(step_implicit_euler(system, state, 1.0 / 60, 20).converged);
    const StaticResult rest = solve_static(solid, conditions);
    const double tip = face_mean(solid.mesh, rest.displacement, Face::z_max).y;
    EXPECT_NEAR(face_mean(solid.mesh, displacement(solid, state), Face::z_max).y / tip, 1, 1e-4);
}

TEST(FemMotion, unconverged_step_leaves_the_state) {
    const Solid solid(box_mesh(ElementType::hexahedra_8, {1, 1, 4}, {0.1, 0.1, 0.4}), soft);
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    add_gravity(conditions, solid, {0, -981, 0});
    System system(solid, conditions);
    State state = at_rest(solid);
    EXPECT_FALSE(step_implicit_euler(system, state, 0.1, 0, {.max_iterations = 1}).converged);
    EXPECT_EQ(state.x, solid.mesh.X);
    EXPECT_EQ(kinetic_energy(system, state), 0);
    EXPECT_TRUE(step_implicit_euler(system, state, 0.1, 0).converged);
    EXPECT_NE(state.x, solid.mesh.X);
}

/// A beam of 0.1 x 0.1 x 1 m of n x n x 10 n triquadratic elements under its weight.
struct HeavyBeam {
    Solid solid;
    Conditions conditions;

    explicit HeavyBeam(std::size_t n)
        : solid(box_mesh(ElementType::hexahedra_27, {n, n, 10 * n}, {0.1, 0.1, 1.0}), soft), conditions(solid) {
        clamp(conditions, solid, Face::z_min);
        add_gravity(conditions, solid, {0, -9.81, 0});
    }
    Vec3 rest() const {
        const StaticResult result = solve_static(solid, conditions);
        EXPECT_TRUE(result.converged);
        return face_mean(solid.mesh, result.displacement, Face::z_max);
    }
};

TEST(FemMotion, heavy_beam_hangs_where_elements_of_higher_order_say) {
    const Vec3 tip = HeavyBeam(2).rest();
    EXPECT_NEAR(tip.y, -0.7468, 2e-4);
    EXPECT_NEAR(tip.z, -0.3968, 2e-4);
}

TEST(FemMotion, LONG_falling_beam_swings_once_and_settles_where_statics_says) {
    const HeavyBeam beam(1);
    System system(beam.solid, beam.conditions);
    State state = at_rest(beam.solid);
    double lowest = 0;
    int when = 0;
    for (int step = 1; step <= 300; ++step) {
        ASSERT_TRUE(step_implicit_euler(system, state, 1.0 / 60, 4, {.tolerance = 1e-7}).converged);
        const double y = face_mean(beam.solid.mesh, displacement(beam.solid, state), Face::z_max).y;
        if (y < lowest) lowest = y, when = step;
    }
    measured("lowest point of the first swing [m]", lowest);
    measured("at step", when);
    const Vec3 tip = face_mean(beam.solid.mesh, displacement(beam.solid, state), Face::z_max);
    EXPECT_LT(norm(tip - beam.rest()), 1e-4);
    EXPECT_LT(lowest, 1.05 * tip.y);
}

}  // namespace
}  // namespace phyxel::fem
