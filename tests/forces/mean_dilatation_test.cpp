#include "forces/mean_dilatation.h"

#include <gtest/gtest.h>

#include "forces/derivatives.h"
#include "support/measured.h"

namespace phyxel {
namespace {

Material nearly_incompressible_material(Law law) {
    return {.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.49, .law = law};
}

/// A body that no lattice plane fits, all of it sharing dilatations or none; half of it ten times as stiff if `mixed`.
Model body(const Scheme& scheme, Law law, bool shared, bool mixed = false) {
    BodySettings settings = turned(settings_of(scheme));
    settings.material = nearly_incompressible_material(law);
    settings.mean_dilatation = shared;
    if (mixed) {
        Material stiff = settings.material;
        stiff.youngs_modulus *= 10;
        stiff.poissons_ratio = 0.48;
        settings.regions.push_back({BoxRegion{{0.1, -1, -1}, {1, 1, 1}}, stiff, 0.1});
    }
    return modelled(make_box({1, 0.8, 0.6}), settings, equal_spacing(scheme, 0.28));
}

/// Calls `check(name, model)` for both lattices, all laws, and a mixture.
template <class Check>
void for_shared_bodies(Check&& check) {
    for (const Scheme& scheme : {all_schemes()[0], all_schemes()[1]}) {
        for (Law law : {Law::linear, Law::saint_venant_kirchhoff, Law::corotated, Law::neo_hookean})
            check(scheme.name + ", law " + std::to_string(static_cast<int>(law)), body(scheme, law, true));
        check(scheme.name + ", mixture", body(scheme, Law::neo_hookean, true, true));
    }
}

TEST(MeanDilatation, force_is_the_gradient_of_the_energy_and_stiffness_that_of_the_force) {
    double worst = 0, worst_stiffness = 0;
    for_shared_bodies([&](const std::string& name, const Model& m) {
        ASSERT_FALSE(m.dilatation.empty()) << name;
        const auto x = turned_stretched_and_shaken(m);
        const double error = force_error(m, x), stiffness = stiffness_error(m, x);
        EXPECT_LE(error, 1e-7) << name;
        EXPECT_LE(stiffness, 1e-7) << name;
        worst = std::max(worst, error);
        worst_stiffness = std::max(worst_stiffness, stiffness);
    });
    measured("force against differences", worst);
    measured("stiffness against differences", worst_stiffness);
}

TEST(MeanDilatation, stiffness_action_is_symmetric) {
    for_shared_bodies([](const std::string& name, const Model& m) {
        const auto x = turned_stretched_and_shaken(m);
        const auto a = random_field(x.size(), 1, 5), b = random_field(x.size(), 1, 6);
        const auto Ka = stiffness_times(m, x, a), Kb = stiffness_times(m, x, b);
        EXPECT_LE(std::abs(inner(b, Ka) - inner(a, Kb)), 1e-13 * std::sqrt(inner(b, b) * inner(Ka, Ka))) << name;
    });
}

TEST(MeanDilatation, stiffness_damping_is_beta_times_the_stiffness_at_rest_and_takes_what_it_says) {
    for_shared_bodies([](const std::string& name, const Model& m) {
        const auto v = random_field(m.rest.size(), 1, 9);
        const auto x = turned_stretched_and_shaken(m);
        auto expected = stiffness_times(m, m.rest, v), damped = forces(m, m.rest, v, 1);
        for (Vec3& f : expected) f *= -1;
        EXPECT_LE(largest_difference(damped, expected), 1e-12 * largest(expected)) << name;

        ForceWorkspace work;
        std::vector<Vec3> f(x.size());
        const double power = internal_forces(m, x, v, 1, work, threads, f);
        const auto elastic = forces(m, x);
        for (std::size_t i = 0; i < f.size(); ++i) f[i] -= elastic[i];
        EXPECT_GT(power, 0) << name;
        EXPECT_LE(std::abs(power + inner(f, v)), 1e-11 * power) << name;
    });
}

TEST(MeanDilatation, affine_motion_cannot_tell_the_cell_from_its_points) {
    for (const Scheme& scheme : {all_schemes()[0], all_schemes()[1]})
        for (Law law : {Law::linear, Law::saint_venant_kirchhoff, Law::corotated, Law::neo_hookean}) {
            const Model shared = body(scheme, law, true), apart = body(scheme, law, false);
            const auto x = affine(shared, some_rotation() * some_stretch());
            const auto f = forces(shared, x), expected = forces(apart, x);
            EXPECT_LE(largest_difference(f, expected), 1e-11 * largest(expected)) << scheme.name;
            EXPECT_NEAR(total_energy(shared, x) / total_energy(apart, x), 1, 1e-12) << scheme.name;
        }
}

TEST(MeanDilatation, point_stresses_carry_the_pressure_of_the_cell) {
    const Model m = body(all_schemes()[0], Law::corotated, true);
    const auto x = turned_stretched_and_shaken(m);
    const std::vector<Mat3> F = deformation_gradients(m, x, threads);
    const PointStresses at = point_stresses(m, F, threads);

    // tr(R^T P) = 2 mu theta_q + 3 p_c: less the point's own part, one number for all points of a cell.
    double widest = 0, energy = 0;
    for (std::size_t c = 0; c < m.dilatation.volume.size(); ++c) {
        double mean = 0;
        std::vector<double> pressure;
        for (std::uint32_t k = m.dilatation.offset[c]; k < m.dilatation.offset[c + 1]; ++k) {
            const std::uint32_t q = m.dilatation.points[k];
            const double theta = dilatation(Law::corotated, F[q]);
            mean += m.volumes[q] * theta / m.dilatation.volume[c];
            pressure.push_back((contract(polar_rotation(F[q]), at.stress[q]) - 2 * m.material.lame.mu * theta) / 3);
        }
        for (double p : pressure)
            widest = std::max(widest, std::abs(p - m.material.lame.lambda * mean) / m.material.lame.lambda);
    }
    EXPECT_LE(widest, 1e-12);
    for (std::size_t q = 0; q < F.size(); ++q) energy += m.volumes[q] * at.energy_density[q];
    ForceWorkspace work;
    EXPECT_NEAR(energy / elastic_energy(m, x, work, threads), 1, 1e-12);
}

TEST(MeanDilatation, is_the_default_above_a_ratio_of_0_47_with_grid_quadrature) {
    const auto groups = [](const Scheme& scheme, double nu, std::optional<bool> wanted) {
        BodySettings settings = settings_of(scheme);
        settings.material.poissons_ratio = nu;
        settings.mean_dilatation = wanted;
        return modelled(make_box({1, 1, 1}), settings, equal_spacing(scheme, 0.25)).dilatation.volume.size();
    };
    EXPECT_EQ(groups(all_schemes()[0], 0.47, {}), 0);
    EXPECT_EQ(groups(all_schemes()[0], 0.471, {}), 64) << "one for each cube between nodes";
    EXPECT_EQ(groups(all_schemes()[0], 0.3, true), 64);
    EXPECT_EQ(groups(all_schemes()[0], 0.49, false), 0);
    EXPECT_EQ(groups(all_schemes()[2], 0.49, {}), 0) << "points at nodes are alone in their cells";
}

TEST(MeanDilatation, cells_hold_every_point_once_and_their_volume) {
    for (const Scheme& scheme : {all_schemes()[0], all_schemes()[1]}) {
        const Model m = body(scheme, Law::neo_hookean, true, true);
        std::vector<int> seen(m.volumes.size());
        double total = 0;
        for (std::size_t c = 0; c < m.dilatation.volume.size(); ++c) {
            double volume = 0;
            for (std::uint32_t k = m.dilatation.offset[c]; k < m.dilatation.offset[c + 1]; ++k) {
                ++seen[m.dilatation.points[k]];
                volume += m.volumes[m.dilatation.points[k]];
                EXPECT_EQ(m.dilatation.cell[m.dilatation.points[k]], c);
            }
            EXPECT_NEAR(volume, m.dilatation.volume[c], 1e-15);
            total += volume;
        }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
        EXPECT_NEAR(total, 0.48, 1e-12);
    }
}

TEST(MeanDilatation, parts_on_the_two_sides_of_a_gap_keep_their_own) {
    // Two blocks a tenth of a spacing apart within one layer of lattice cells.
    TriangleMesh both = make_box({1, 1, 0.9});
    const TriangleMesh other = make_box({1, 1, 0.6});
    const auto first = static_cast<std::uint32_t>(both.vertices.size());
    for (const Vec3& X : other.vertices) both.vertices.push_back(X + Vec3{0, 0, 0.8});
    for (const Triangle& t : other.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    BodySettings settings = settings_of(all_schemes()[0]);
    settings.mean_dilatation = true;
    const Model m = modelled(both, settings, 0.25);
    const auto side = [&](std::uint32_t q) { return m.sampling.frame.to_rest(m.sampling.points[q]).z > 0.475; };
    for (std::size_t c = 0; c < m.dilatation.volume.size(); ++c)
        for (std::uint32_t k = m.dilatation.offset[c]; k < m.dilatation.offset[c + 1]; ++k)
            EXPECT_EQ(side(m.dilatation.points[k]), side(m.dilatation.points[m.dilatation.offset[c]]));
}

}  // namespace
}  // namespace phyxel
