/// Nearly incompressible material bends as it should: the beam of Brunet et al. 2019, 20 x 20 x 200 mm, 50 N/mm^2,
/// clamped at one face and loaded by 12 N at the other, with 189 nodes.
#include <gtest/gtest.h>

#define EIGEN_MPL2_ONLY
#include <Eigen/Dense>

#include "forces/derivatives.h"
#include "forces/loads.h"
#include "support/measured.h"

namespace phyxel {
namespace {

/// Newton's method with a dense matrix, column by column: slow, and no solver under test. Nodes at z = -0.1 are held.
std::vector<Vec3> equilibrium(const Model& m, std::span<const Vec3> load) {
    std::vector<Vec3> x = m.rest;
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (x[i].z > -0.1 + 1e-9)
            for (std::size_t c = 0; c < 3; ++c) free.push_back(3 * i + c);
    const auto n = static_cast<Eigen::Index>(free.size());
    const auto entry = [&](std::span<const Vec3> field, Eigen::Index k) {
        return field[free[static_cast<std::size_t>(k)] / 3][free[static_cast<std::size_t>(k)] % 3];
    };
    for (int iteration = 0; iteration < 7; ++iteration) {
        const std::vector<Vec3> f = forces(m, x);
        Eigen::MatrixXd K(n, n);
        Eigen::VectorXd r(n);
        for (Eigen::Index j = 0; j < n; ++j) {
            std::vector<Vec3> unit(x.size());
            const std::size_t at = free[static_cast<std::size_t>(j)];
            unit[at / 3][at % 3] = 1;
            const std::vector<Vec3> column = stiffness_times(m, x, unit);
            for (Eigen::Index k = 0; k < n; ++k) K(k, j) = entry(column, k);
            r[j] = entry(f, j) + entry(load, j);
        }
        const Eigen::VectorXd dx = K.partialPivLu().solve(r);
        for (Eigen::Index k = 0; k < n; ++k)
            x[free[static_cast<std::size_t>(k)] / 3][free[static_cast<std::size_t>(k)] % 3] += dx[k];
        if (dx.norm() < 1e-9) break;
    }
    return x;
}

/// Tip deflection [mm].
double deflection(double nu, std::optional<bool> mean_dilatation = {}) {
    BodySettings settings = settings_of(all_schemes()[0]);
    settings.material = corotated({.density = 1000, .youngs_modulus = 5e7, .poissons_ratio = nu});
    settings.mean_dilatation = mean_dilatation;
    const CheckedMesh checked = check_and_repair(make_box({0.02, 0.02, 0.2}));
    const Model m = modelled(checked.mesh, settings, 0.01);
    std::vector<Vec3> load(m.rest.size());
    SurfaceLoad(m, checked.mesh, {.box = {{-1, -1, 0.0999}, {1, 1, 1}}, .force = Vec3{0, -12, 0}}, threads)
        .add(0, m.rest, load);
    const std::vector<Vec3> x = equilibrium(m, load);
    const Vec3 tip = m.sampling.frame.to_lattice({0, 0, 0.1});
    const std::uint32_t cell = m.sampling.locate(tip, {});
    return -1e3 * embed(m.sampling, m.approximation, std::span(&tip, 1), std::span(&cell, 1), Gradients::no, threads)
                      .position(0, x)
                      .y;
}

TEST(Locking, LONG_shared_dilatation_bends_a_beam_two_cells_thick_as_much_as_it_should) {
    constexpr double converged = 44.95;  // [mm] triquadratic hexahedra: 45.02 at nu = 0.49, 44.9 at 0.499
    const double shared = deflection(0.4999), apart = deflection(0.4999, false);
    EXPECT_NEAR(shared, converged, 0.015 * converged);
    EXPECT_LT(apart, 0.93 * converged) << "locks";
    measured("deflection", shared);
    measured("deflection without", apart);
}

}  // namespace
}  // namespace phyxel
