#include "model/model.h"

#include <gtest/gtest.h>

#include <numeric>

#include "model/modelled.h"
#include "support/measured.h"

namespace phyxel {
namespace {

TEST(Model, mass_is_density_times_the_volume_of_the_mesh_and_every_node_has_some) {
    double worst = 0;
    for (const Scheme& scheme : all_schemes())
        for (const auto& [name, mesh] : patch_bodies()) {
            const Model m = modelled(mesh, turned(settings_of(scheme)), equal_spacing(scheme, 0.125));
            const double exact = m.settings.density * volume_moments(mesh).volume;
            EXPECT_NEAR(m.total_mass / exact, 1, 1e-12) << scheme.name << ", " << name;
            EXPECT_NEAR(std::accumulate(m.mass.begin(), m.mass.end(), 0.0) / exact, 1, 1e-12) << scheme.name;
            for (std::size_t i = 0; i < m.mass.size(); ++i) {
                ASSERT_GT(m.mass[i], 0) << scheme.name << ", " << name;
                EXPECT_DOUBLE_EQ(m.mass[i] * m.inverse_mass[i], 1);
            }
            worst = std::max(worst, std::abs(m.total_mass / exact - 1));
        }
    measured("mass", worst);
}

TEST(Model, node_length_is_the_edge_of_a_cube_of_one_nodes_volume) {
    const double a = 0.2;
    EXPECT_DOUBLE_EQ(modelled(make_box({1, 1, 1}), settings_of(all_schemes()[0]), a).node_length, a);
    EXPECT_DOUBLE_EQ(modelled(make_box({1, 1, 1}), settings_of(all_schemes()[1]), a).node_length, a / std::cbrt(2.0));
}

TEST(Model, filter_and_nodal_weights_leave_linear_fields_alone) {
    for (const Scheme& scheme : all_schemes()) {
        const Model m = modelled(unit_bunny(), turned(settings_of(scheme)), equal_spacing(scheme, 0.125));
        EXPECT_EQ(m.filter.rows.offset.empty(), scheme.quadrature == Quadrature::nodes) << scheme.name;
        EXPECT_EQ(m.nodal.kappa.empty(), scheme.quadrature == Quadrature::grid) << scheme.name;
        const auto x = affine(m, some_stretch(), {1, 2, 3});
        double worst = 0;
        for (std::size_t i = 0; i + 1 < m.filter.rows.offset.size(); ++i) {
            Vec3 left{};
            for (std::uint32_t k = m.filter.rows.offset[i]; k < m.filter.rows.offset[i + 1]; ++k)
                left += m.filter.rows.value[k] * x[m.filter.rows.column[k]];
            worst = std::max(worst, norm(left));
        }
        EXPECT_LE(worst, 1e-13) << scheme.name;
    }
}

TEST(Model, stabilization_follows_the_modulus_of_a_new_material) {
    Model m = modelled(make_sphere(0.5), settings_of(all_schemes()[2]), 0.2);
    const std::vector<double> kappa = m.nodal.kappa;
    Material stiffer = m.settings;
    stiffer.youngs_modulus *= 7;
    set_material(m, stiffer);
    for (std::size_t q = 0; q < kappa.size(); ++q) EXPECT_DOUBLE_EQ(m.nodal.kappa[q], 7 * kappa[q]);
    EXPECT_EQ(m.settings, stiffer);
}

TEST(Model, strength_of_the_stabilization_is_the_setting_or_its_default) {
    BodySettings settings = settings_of(all_schemes()[0]);
    EXPECT_EQ(modelled(make_sphere(0.5), settings, 0.2).stabilization, 0.2);
    settings.stabilization = 0.7;
    EXPECT_EQ(modelled(make_sphere(0.5), settings, 0.2).stabilization, 0.7);
    settings.stabilization = 0;
    EXPECT_TRUE(modelled(make_sphere(0.5), settings, 0.2).filter.rows.offset.empty());
    settings = settings_of(all_schemes()[2]);
    EXPECT_EQ(modelled(make_sphere(0.5), settings, 0.2).stabilization, 0.15);
}

}  // namespace
}  // namespace phyxel
