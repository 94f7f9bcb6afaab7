#include "model/mixture.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "model/modelled.h"
#include "phyxel/error.h"
#include "support/measured.h"

namespace phyxel {
namespace {

const Material soft = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
const Material stiff = {.density = 3000, .youngs_modulus = 1e7, .poissons_ratio = 0.4};

BodySettings with(const Scheme& scheme, std::vector<Region> regions) {
    BodySettings settings = settings_of(scheme);
    settings.material = soft;
    settings.regions = std::move(regions);
    return settings;
}

/// Volume of what the regions hold, sum of share times V_q.
double held_volume(const Model& m, std::uint16_t material) {
    double volume = 0;
    for (std::size_t q = 0; q < m.volumes.size(); ++q)
        for (std::uint32_t k = m.mixture.offset[q]; k < m.mixture.offset[q + 1]; ++k)
            if (m.mixture.material[k] == material) volume += m.mixture.share[k] * m.volumes[q];
    return volume;
}

TEST(Mixture, mass_is_the_sum_of_density_times_volume_wherever_a_boxs_faces_cut_the_lattice) {
    double worst = 0;
    for (const Scheme& scheme : all_schemes())
        for (double cut : {0.0, 0.03, 0.1, 0.125, 0.21}) {
            const Model m = modelled(make_box({1, 1, 1}), with(scheme, {{BoxRegion{{-2, -2, cut}, {2, 2, 2}}, stiff}}),
                                     equal_spacing(scheme, 0.25));
            const double exact = 1000 * (0.5 + cut) + 3000 * (0.5 - cut);
            // Whole octants are cut exactly; a cell of points at nodes, or a box of the body-centred lattice at the
            // surface, stands for a cube it does not fill.
            const bool whole = scheme.lattice == Lattice::cubic;
            EXPECT_NEAR(m.total_mass / exact, 1, whole ? 1e-12 : 0.02) << scheme.name << ", " << cut;
            EXPECT_NEAR(std::accumulate(m.mass.begin(), m.mass.end(), 0.0), m.total_mass, 1e-12 * exact);
            if (whole) worst = std::max(worst, std::abs(m.total_mass / exact - 1));
        }
    measured("mass", worst);
}

TEST(Mixture, spheres_and_meshes_hold_their_volume) {
    const double exact = 4 * std::numbers::pi / 3 * 0.3 * 0.3 * 0.3;
    TriangleMesh ball = make_sphere(0.3);
    for (Vec3& X : ball.vertices) X += Vec3{0.05, 0.02, -0.03};
    for (const bool is_mesh : {false, true}) {
        Region region{SphereRegion{{0.05, 0.02, -0.03}, 0.3}, stiff};
        if (is_mesh) region.shape = ball;
        const Model m = modelled(make_box({1, 1, 1}), turned(with(all_schemes()[0], {region})), 0.1);
        EXPECT_NEAR(held_volume(m, 1) / exact, 1, 0.01) << is_mesh;
        measured(is_mesh ? "mesh" : "sphere", held_volume(m, 1) / exact - 1);
    }
}

TEST(Mixture, shares_add_up_and_later_regions_win) {
    const Model m = modelled(make_box({1, 1, 1}),
                             with(all_schemes()[0], {{BoxRegion{{-1, -1, 0}, {1, 1, 1}}, stiff},
                                                     {BoxRegion{{-1, -1, -1}, {0, 1, 1}}, soft}}),
                             0.25);
    for (std::size_t q = 0; q < m.volumes.size(); ++q) {
        const Vec3 X = m.sampling.frame.to_rest(m.sampling.points[q]);
        ASSERT_EQ(m.mixture.offset[q + 1] - m.mixture.offset[q], 1u) << "octants are whole here";
        EXPECT_EQ(m.mixture.main_material(q), X.x < 0 ? 2 : X.z > 0 ? 1 : 0);
        EXPECT_EQ(m.mixture.share[m.mixture.offset[q]], 1);
    }
}

TEST(Mixture, moduli_and_density_change_linearly_over_a_transition) {
    const double width = 0.5;
    const Model m = modelled(make_box({1, 1, 1}),
                             with(all_schemes()[0], {{BoxRegion{{-9, -9, 0}, {9, 9, 9}}, stiff, width}}), 0.125);
    for (std::size_t q = 0; q < m.volumes.size(); ++q) {
        // A point stands for its octant, whose centre is what counts.
        const double z = (std::floor(m.sampling.frame.to_rest(m.sampling.points[q]).z / 0.0625) + 0.5) * 0.0625;
        const double part = std::clamp(0.5 + z / width, 0.0, 1.0);
        const Lame a = lame(soft), b = lame(stiff);
        EXPECT_NEAR(m.point_material(q).lame.mu, a.mu + part * (b.mu - a.mu), 1e-9 * b.mu);
        EXPECT_NEAR(m.point_material(q).lame.lambda, a.lambda + part * (b.lambda - a.lambda), 1e-9 * b.lambda);
        EXPECT_NEAR(m.mixture.mean(q, &Material::density), 1000 + 2000 * part, 1e-6);
    }
}

TEST(Mixture, of_one_material_is_that_material) {
    for (const Scheme& scheme : all_schemes()) {
        const BodySettings plain = turned(with(scheme, {}));
        BodySettings mixed = plain;
        mixed.regions = {{SphereRegion{{0.1, 0, 0}, 0.3}, soft, 0.1}};
        const Model a = modelled(make_sphere(0.5), plain, equal_spacing(scheme, 0.2)),
                    b = modelled(make_sphere(0.5), mixed, equal_spacing(scheme, 0.2));
        EXPECT_TRUE(a.uniform());
        EXPECT_FALSE(b.uniform());
        for (std::size_t i = 0; i < a.mass.size(); ++i) EXPECT_NEAR(a.mass[i], b.mass[i], 1e-12 * a.mass[i]);
        for (std::size_t i = 0; i < a.filter_stiffness.size(); ++i)
            EXPECT_NEAR(a.filter_stiffness[i], b.filter_stiffness[i], 1e-12 * a.filter_stiffness[i]);
        for (std::size_t q = 0; q < a.nodal.kappa.size(); ++q)
            EXPECT_NEAR(a.nodal.kappa[q], b.nodal.kappa[q], 1e-12 * a.nodal.kappa[q]);
    }
}

TEST(Mixture, where_laws_differ_every_point_has_one_of_them) {
    Material other = corotated(stiff);
    const Model m =
        modelled(make_box({1, 1, 1}), turned(with(all_schemes()[0], {{SphereRegion{{}, 0.3}, other}})), 0.2);
    std::size_t inner = 0;
    for (std::size_t q = 0; q < m.volumes.size(); ++q) {
        const MaterialPoint& point = m.point_material(q);
        const Lame expected = lame(point.law == Law::corotated ? stiff : soft);
        EXPECT_EQ(point.lame.mu, expected.mu);
        inner += point.law == Law::corotated;
    }
    EXPECT_GT(inner, 50u);
}

TEST(Mixture, refuses_a_transition_between_two_laws_and_a_mesh_without_inside) {
    const auto built = [](Region region) { modelled(make_box({1, 1, 1}), with(all_schemes()[0], {region}), 0.25); };
    EXPECT_THROW(built({SphereRegion{{}, 0.3}, corotated(stiff), 0.2}), Error);
    TriangleMesh flat;
    flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    flat.triangles = {{0, 1, 2}};
    EXPECT_THROW(built({flat, stiff}), Error);
}

TEST(Mixture, new_material_of_a_region_moves_moduli_and_stabilization_there_alone) {
    for (const Scheme& scheme : all_schemes()) {
        const Region region{BoxRegion{{-9, -9, 0}, {9, 9, 9}}, stiff};
        Model m = modelled(make_box({1, 1, 1}), with(scheme, {region}), equal_spacing(scheme, 0.125));
        Material stiffer = stiff;
        stiffer.youngs_modulus *= 3;
        set_material(m, stiffer, 1);
        Region new_region = region;
        new_region.material = stiffer;
        const Model built = modelled(make_box({1, 1, 1}), with(scheme, {new_region}), equal_spacing(scheme, 0.125));
        EXPECT_EQ(m.largest_modulus, stiffer.youngs_modulus);
        for (std::size_t q = 0; q < m.volumes.size(); ++q)
            EXPECT_EQ(m.point_material(q).lame.mu, built.point_material(q).lame.mu) << scheme.name;
        for (std::size_t i = 0; i < m.filter_stiffness.size(); ++i)
            EXPECT_DOUBLE_EQ(m.filter_stiffness[i], built.filter_stiffness[i]);
        for (std::size_t q = 0; q < m.nodal.kappa.size(); ++q)
            EXPECT_NEAR(m.nodal.kappa[q], built.nodal.kappa[q], 1e-14 * built.nodal.kappa[q]);
    }
}

}  // namespace
}  // namespace phyxel
