#include <gtest/gtest.h>

#include <cmath>

#include "reference/fem/solve.h"
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
    Vec3 tip;  ///< displacement of the centre of the end face [mm]

    Beam(ElementType type, std::size_t n, const Vec3& force, const Material& material = beam_material,
         Split split = Split::six)
        : solid(box_mesh(type, {n, n, 10 * n}, beam_size, split), material) {
        Conditions conditions(solid);
        clamp(conditions, solid, Face::z_min);
        add_face_force(conditions, solid, Face::z_max, force);
        result = solve_static(solid, conditions);
        tip = 1e3 * interpolate(solid.mesh, result.displacement, {0.01, 0.01, 0.2});
        EXPECT_TRUE(result.converged) << "residual " << result.residual << " after " << result.iterations;
    }
};

TEST(FemBeam, triquadratic_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 1, bending).tip.y, -43.7929, 1e-4);
    EXPECT_NEAR(Beam(ElementType::hexahedra_27, 2, bending).tip.y, -44.6635, 1e-4);
}

TEST(FemBeam, trilinear_hexahedra_bend_as_another_program_found) {
    EXPECT_NEAR(Beam(ElementType::hexahedra_8, 4, bending).tip.y, -41.7268, 1e-4);
}

TEST(FemBeam, mirrored_tetrahedra_bend_alike_and_drift_to_opposite_sides) {
    const Beam beam(ElementType::tetrahedra, 4, bending);
    const Beam mirrored(ElementType::tetrahedra, 4, bending, beam_material, Split::six_mirrored);
    EXPECT_NEAR(beam.tip.y, mirrored.tip.y, 1e-6);
    EXPECT_NEAR(beam.tip.x, 4.68, 0.01);
    EXPECT_NEAR(mirrored.tip.x, -4.68, 0.01);
}

}  // namespace
}  // namespace phyxel::fem
