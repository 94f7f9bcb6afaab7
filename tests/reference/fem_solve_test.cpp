#include "reference/fem/solve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/measured.h"

namespace phyxel::fem {
namespace {

/// The beam of Brunet et al. 2019, section 4.1, along z, clamped at z = 0.
const Vec3 beam_size = {0.02, 0.02, 0.2};
const Material beam_material = {.density = 1000, .youngs_modulus = 50e6, .poissons_ratio = 0.45, .law = Law::corotated};
const Vec3 bending = {0, -12, 0}, stretching = {0, 0, 1500};  // dead forces on its end [N]

/// That beam of n x n x 10 n boxes, in equilibrium with a force on its end.
struct Beam {
    Solid solid;
    StaticResult result;
    Vec3 tip;           ///< displacement of the centre of the end face [mm]
    double energy = 0;  ///< elastic [N mm]

    Beam(ElementType type, std::size_t n, const Vec3& force, const Material& material = beam_material,
         Split split = Split::six)
        : solid(box_mesh(type, {n, n, 10 * n}, beam_size, split), material) {
        Conditions conditions(solid);
        clamp(conditions, solid, Face::z_min);
        add_face_force(conditions, solid, Face::z_max, force);
        result = solve_static(solid, conditions);
        EXPECT_TRUE(result.converged) << "residual " << result.residual << " after " << result.iterations;
        EXPECT_LE(result.iterations, 9);
        tip = 1e3 * interpolate(solid.mesh, result.displacement, {0.01, 0.01, 0.2});
        std::vector<Vec3> x = solid.mesh.X;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += result.displacement[i];
        energy = 1e3 * elastic_energy(solid, x);
    }
};

// Printed digits of a separate program for the same elements; refined, both agree with CalculiX to 0.09 %.

TEST(FemBeam, triquadratic_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 1, bending).tip.y, -43.7929, 1e-4);
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 2, bending).tip.y, -44.6635, 1e-4);
}

TEST(FemBeam, LONG_finer_triquadratic_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 3, bending).tip.y, -44.8917, 1e-4);
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 4, bending).tip.y, -44.9878, 1e-4);
}

TEST(FemBeam, trilinear_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_8, 4, bending).tip.y, -41.7268, 1e-4);
}

TEST(FemBeam, LONG_finer_trilinear_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_8, 8, bending).tip.y, -44.0919, 1e-4);
}

TEST(FemBeam, stretches_by_what_the_law_says) {
    // Converged values, approached from below: elements of a fifth of the side miss what the clamp's corners do.
    const Beam coarse(ElementType::hexahedra_27, 1, stretching), beam(ElementType::hexahedra_27, 2, stretching);
    EXPECT_LT(coarse.tip.z, beam.tip.z);
    EXPECT_LT(beam.tip.z, 14.8789);
    measured("stretching, error of 1025 nodes", beam.tip.z / 14.8789 - 1);
    EXPECT_NEAR(beam.tip.z / 14.8789, 1, 3e-3);
    EXPECT_NEAR(beam.energy / 11156.3, 1, 3e-3);
}

TEST(FemBeam, LONG_laws_differ_by_a_tenth_in_stretching_and_little_in_bending) {
    const auto error = [](const Vec3& force, Law law, double expected) {
        const Beam beam(ElementType::hexahedra_27, 3, force, with_law(beam_material, law));
        return std::abs((force.z > 0 ? beam.tip.z : beam.tip.y) / expected - 1);
    };
    EXPECT_LT(error(stretching, Law::corotated, 14.8789), 2e-3);
    EXPECT_LT(error(stretching, Law::saint_venant_kirchhoff, 13.4728), 2e-3);
    EXPECT_LT(error(bending, Law::saint_venant_kirchhoff, -45.169), 7e-3);
    EXPECT_LT(error(bending, Law::neo_hookean, -45.174), 7e-3);
}

TEST(FemBeam, mirrored_tetrahedra_bend_alike_and_drift_to_opposite_sides) {
    // Brunet et al. 2019, figure 7, lets them converge to different deflections; 4.68 mm from another program.
    const Beam beam(ElementType::tetrahedra, 4, bending);
    const Beam mirrored(ElementType::tetrahedra, 4, bending, beam_material, Split::six_mirrored);
    EXPECT_NEAR(beam.tip.y, mirrored.tip.y, 1e-6);
    EXPECT_NEAR(beam.tip.x, 4.68, 0.01);
    EXPECT_NEAR(mirrored.tip.x, -4.68, 0.01);
    EXPECT_NEAR(beam.tip.y / -45.162, 0.63, 0.01);
}

TEST(FemBeam, symmetric_cuts_into_tetrahedra_do_not_drift) {
    for (const Split split : {Split::six_alternating, Split::five})
        EXPECT_NEAR(Beam(ElementType::tetrahedra, 2, bending, beam_material, split).tip.x, 0, 1e-6);
}

TEST(FemBeam, LONG_low_order_elements_lock_when_nearly_incompressible) {
    const auto shortfall = [](ElementType type, double nu) {
        Material material = beam_material;
        material.poissons_ratio = nu;
        return 1 - Beam(type, 4, bending, material).tip.y / (nu < 0.495 ? -45.02 : -44.9);
    };
    EXPECT_NEAR(shortfall(ElementType::hexahedra_8, 0.49), 0.18, 0.005);
    EXPECT_NEAR(shortfall(ElementType::hexahedra_8, 0.499), 0.38, 0.005);
    EXPECT_NEAR(shortfall(ElementType::tetrahedra, 0.49), 0.69, 0.005);
    EXPECT_NEAR(shortfall(ElementType::tetrahedra, 0.499), 0.94, 0.005);
}

/// End displacement [mm] of one element under uniaxial stress: symmetry planes through the origin, 1500 N along z.
double uniaxial(ElementType type, Law law) {
    const Solid solid(box_mesh(type, {1, 1, 1}, beam_size), with_law(beam_material, law));
    Conditions conditions(solid);
    for (const auto& [face, axis] : {std::pair(Face::x_min, 0), std::pair(Face::y_min, 1), std::pair(Face::z_min, 2)}) {
        const std::vector<bool> on = nodes_on(solid.mesh, face);
        for (std::size_t i = 0; i < on.size(); ++i)
            if (on[i]) conditions.fixed[3 * i + axis] = 1;
    }
    add_face_force(conditions, solid, Face::z_max, stretching);
    const StaticResult result = solve_static(solid, conditions);
    EXPECT_TRUE(result.converged);
    return 1e3 * result.displacement.back().z;
}

TEST(FemStatics, free_bar_stretches_as_in_closed_form) {
    for (const ElementType type : {ElementType::tetrahedra, ElementType::hexahedra_8, ElementType::hexahedra_27}) {
        EXPECT_NEAR(uniaxial(type, Law::corotated), 15, 1e-9);  // F L/(E A)
        EXPECT_NEAR(uniaxial(type, Law::neo_hookean), 16.0942, 1e-4);
    }
}

TEST(FemStatics, hanging_cube_without_lateral_strain_sags_by_half_of_rho_g_L_squared_over_E) {
    for (const double E : {1e4, 1e7, 1e11})
        for (const ElementType type : {ElementType::hexahedra_8, ElementType::hexahedra_27}) {
            const Material material = {
                .density = 1000, .youngs_modulus = E, .poissons_ratio = 0, .law = Law::corotated};
            const Solid solid(box_mesh(type, {2, 2, 2}, {0.1, 0.1, 0.1}), material);
            Conditions conditions(solid);
            clamp(conditions, solid, Face::y_max);
            add_gravity(conditions, solid, {0, -9.81, 0});
            const StaticResult result = solve_static(solid, conditions);
            ASSERT_TRUE(result.converged);
            const double sag = -face_mean(solid.mesh, result.displacement, Face::y_min).y;
            EXPECT_NEAR(sag * E / (0.5 * 1000 * 9.81 * 0.01), 1, 1e-6) << E;
        }
}

/// A column of 1 x 1 x 10 triquadratic elements under `push` [N] along its axis and that part of it sideways.
StaticResult pushed_column(double push, double sideways, const NewtonSettings& settings = {}) {
    const Solid solid(box_mesh(ElementType::hexahedra_27, {1, 1, 10}, beam_size), beam_material);
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    add_face_force(conditions, solid, Face::z_max, {0, sideways * push, -push});
    return solve_static(solid, conditions, settings);
}

/// Largest push that a clamped column bears straight: pi^2 E I/(2 L)^2 [N].
const double eulers_load = M_PI * M_PI * 50e6 * std::pow(0.02, 4) / 12 / (4 * 0.2 * 0.2);

TEST(FemStatics, column_buckles_to_the_side_above_eulers_load) {
    const StaticResult below = pushed_column(0.5 * eulers_load, 1e-3), above = pushed_column(1.5 * eulers_load, 1e-3);
    EXPECT_TRUE(below.converged);
    EXPECT_LT(std::abs(below.displacement.back().y), 0.002);
    EXPECT_TRUE(above.converged) << above.residual;
    EXPECT_GT(above.displacement.back().y, 0.1);
}

TEST(FemStatics, does_not_take_a_column_that_would_buckle_for_one_at_rest) {
    EXPECT_TRUE(pushed_column(0.5 * eulers_load, 0).converged);
    const StaticResult straight = pushed_column(1.5 * eulers_load, 0);
    EXPECT_TRUE(!straight.converged || std::abs(straight.displacement.back().y) > 0.1);
}

TEST(FemStatics, says_when_it_did_not_converge) {
    const StaticResult stopped = pushed_column(10, 1e-3, {.max_iterations = 1});
    EXPECT_FALSE(stopped.converged);
    EXPECT_GT(stopped.residual, 1e-9);
    EXPECT_TRUE(pushed_column(10, 1e-3).converged);
}

}  // namespace
}  // namespace phyxel::fem
