#include "forces/cell_blocks.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/all_laws.h"
#include "model/modelled.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

BodySettings plain_settings(const Scheme& scheme = all_schemes()[0]) {
    BodySettings settings = settings_of(scheme);
    settings.stabilization = 0;  // not the blocks' business
    return settings;
}

/// Two plates, a quarter of the spacing apart: nodes in one box on either side of the gap.
TriangleMesh two_plates(double spacing) {
    const TriangleMesh plate = make_box({1, 1, 0.3});
    return joined(plate, moved(plate, {0, 0, 0.3 + 0.25 * spacing}));
}

Model beam() { return modelled(make_box({0.1, 0.1, 0.8}), plain_settings(), 0.025); }
Model thick_box() { return modelled(make_box({1.2, 1.2, 1.2}), plain_settings(), 0.1); }

const std::vector<NamedModel>& bodies() {
    static const std::vector<NamedModel> all = [] {
        std::vector<NamedModel> cases;
        cases.push_back({"beam", beam()});
        cases.push_back({"thick box", thick_box()});
        cases.push_back({"sphere", modelled(make_sphere(0.5), plain_settings(), 0.125)});
        cases.push_back({"bunny", modelled(unit_bunny(), plain_settings(), 0.1)});
        cases.push_back({"plates with a gap", modelled(two_plates(0.2), plain_settings(), 0.2)});
        for (const Scheme& scheme : all_schemes())
            cases.push_back({scheme.name + ", turned", modelled(make_box({1, 0.8, 0.6}), turned(plain_settings(scheme)),
                                                                equal_spacing(scheme, 0.22))});
        return cases;
    }();
    return all;
}

std::vector<Vec3> double_forces(const Model& m, std::span<const Vec3> x) {
    ForceWorkspace work;
    std::vector<Vec3> f(x.size());
    internal_forces(m, x, {}, 0, work, threads, f);
    return f;
}

std::vector<Vec3> float_forces(const CellBlocks& blocks, const Model& m, std::span<const Vec3> x,
                               const Threads& with = threads) {
    std::vector<Vec3> f(x.size());
    blocks.forces(m, x, with, f);
    return f;
}

double error_of(const CellBlocks& blocks, const Model& m, std::span<const Vec3> x) {
    const auto exact = double_forces(m, x);
    return largest_difference(float_forces(blocks, m, x), exact) / largest(exact);
}

/// As a body is built whose gradients the cache does not hold.
const CellOptions large_body = {.cached_gradients = 0};

constexpr Instructions all_instructions[] = {Instructions::plain, Instructions::avx2, Instructions::avx512};

TEST(CellBlocks, forces_are_those_in_double_precision) {
    double worst = 0;
    for (auto [name, m] : bodies())
        for (const Instructions instructions : all_instructions) {
            if (instructions > best_instructions()) continue;
            for (const auto& [law, material] : all_laws()) {
                set_material(m, material);
                const auto x = turned_stretched_and_shaken(m);
                for (const std::size_t cached : {CellOptions{}.cached_gradients, large_body.cached_gradients}) {
                    const CellBlocks blocks(m, threads, {.instructions = instructions, .cached_gradients = cached});
                    const double error = error_of(blocks, m, x);
                    EXPECT_LE(error, 1e-5) << name << ", " << law;
                    worst = std::max(worst, error);
                }
            }
        }
    measured("force against double precision", worst);
}

TEST(CellBlocks, points_may_differ_in_law_and_moduli) {
    for (auto [name, m] : bodies()) {
        const auto laws = all_laws();
        m.point_materials.clear();
        for (const Vec3& X : m.sampling.points) {
            const std::size_t slice = static_cast<std::size_t>(100 + 7 * X.z / m.sampling.spacing) % laws.size();
            Material material = laws[slice].second;
            material.poissons_ratio = 0.3;
            material.youngs_modulus *= 1 + X.x * X.x;
            m.point_materials.push_back(material_point(material));
        }
        EXPECT_LE(error_of(CellBlocks(m, threads), m, turned_stretched_and_shaken(m)), 1e-5) << name;
    }
}

TEST(CellBlocks, energy_is_that_in_double_precision) {
    double worst = 0;
    for (auto [name, m] : bodies())
        for (const auto& [law, material] : all_laws()) {
            set_material(m, material);
            ForceWorkspace work;
            const auto x = turned_stretched_and_shaken(m);
            const double exact = elastic_energy(m, x, work, threads);
            for (const CellOptions& options : {CellOptions{}, large_body}) {
                const double error = std::abs(CellBlocks(m, threads, options).energy(m, x, threads) / exact - 1);
                EXPECT_LE(error, 1e-6) << name << ", " << law;
                worst = std::max(worst, error);
            }
        }
    measured("energy against double precision", worst);
}

TEST(CellBlocks, rest_action_is_the_stiffness_action_at_rest) {
    double worst = 0;
    for (auto [name, m] : bodies())
        for (const auto& [law, material] : all_laws()) {
            if (material.volume_stiffness > 0) continue;  // not Hooke's at rest
            set_material(m, material);
            const CellBlocks blocks(m, threads);
            const auto d = random_field(m.rest.size(), 1, 7);
            std::vector<Vec3> exact(d.size()), result;
            ForceWorkspace work;
            stiffness_action(m, m.rest, d, work, threads, exact);
            std::vector<Vec3f> d_float, out(d.size());
            for (const Vec3& v : d) d_float.push_back(vector_cast<float>(v));
            blocks.rest_action(m, d_float, threads, out);
            for (const Vec3f& v : out) result.push_back(vector_cast<double>(v));
            const double error = largest_difference(result, exact) / largest(exact);
            EXPECT_LE(error, 1e-5) << name << ", " << law;
            worst = std::max(worst, error);
        }
    measured("rest action against double precision", worst);
}

TEST(CellBlocks, turned_body_far_from_the_origin_feels_no_force) {
    for (auto [name, m] : bodies())
        for (const auto& [law, material] : all_laws()) {
            if (material.law == Law::linear) continue;
            set_material(m, material);
            const CellBlocks blocks(m, threads);
            const auto x = affine(m, rotation_about(normalized(Vec3{1, 1, 0}), 1.5707963), {1e4, -2e4, 3e4});
            const double a = m.node_length, E = m.settings.youngs_modulus;
            EXPECT_LE(largest(float_forces(blocks, m, x)), 1e-9 * E * a * a) << name << ", " << law;
            EXPECT_LE(blocks.energy(m, x, threads), 1e-18 * E * m.sampling.clipped_volume) << name << ", " << law;
        }
}

TEST(CellBlocks, small_strain_keeps_its_digits) {
    for (auto [name, m] : bodies())
        for (const auto& [law, material] : all_laws()) {
            if (material.law == Law::linear) continue;
            set_material(m, material);
            const CellBlocks blocks(m, threads);
            auto x = affine(m, rotation_about(normalized(Vec3{1, 2, 3}), 2.5));
            const auto shake = random_field(x.size(), 1e-6 * m.node_length, 4);
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += shake[i];
            EXPECT_LE(error_of(blocks, m, x), 1e-5) << name << ", " << law;
        }
}

TEST(CellBlocks, inverted_flattened_and_collapsed_bodies_give_finite_forces) {
    for (auto [name, m] : bodies())
        for (const auto& [law, material] : all_laws()) {
            set_material(m, material);
            const CellBlocks blocks(m, threads);
            for (const Mat3& F : {Mat3::diagonal({-1, 1, 1}), Mat3::diagonal({-1, -1, -1}), Mat3::diagonal({1, 1, 0}),
                                  Mat3::diagonal({1, 0, 0}), Mat3{}, Mat3::diagonal({1e6, 1, 1e-6}),
                                  Mat3::diagonal({-0.3, 1.1, 0.8})}) {
                const auto f = float_forces(blocks, m, affine(m, F));
                EXPECT_TRUE(std::all_of(f.begin(), f.end(), [](const Vec3& v) { return is_finite(v); }))
                    << name << ", " << law;
                EXPECT_TRUE(std::isfinite(blocks.energy(m, affine(m, F), threads))) << name << ", " << law;
            }
            const auto scrambled = random_field(m.rest.size(), 1, 12);
            const auto f = float_forces(blocks, m, scrambled);
            EXPECT_TRUE(std::all_of(f.begin(), f.end(), [](const Vec3& v) { return is_finite(v); })) << name;
            EXPECT_LE(error_of(blocks, m, scrambled), 1e-4) << name << ", " << law;
        }
}

TEST(CellBlocks, are_the_same_for_any_number_of_threads) {
    for (const auto& [name, m] : bodies()) {
        const CellBlocks blocks(m, threads, large_body);
        const auto x = turned_stretched_and_shaken(m), f = float_forces(blocks, m, x);
        const double energy = blocks.energy(m, x, threads);
        std::vector<Vec3f> d, Kd(x.size());
        for (const Vec3& v : random_field(x.size(), 1, 7)) d.push_back(vector_cast<float>(v));
        blocks.rest_action(m, d, threads, Kd);
        for (const int count : {1, 3, 8}) {
            const Threads other(count);
            const CellBlocks again(m, other, large_body);
            std::vector<Vec3f> Kd_again(x.size());
            again.rest_action(m, d, other, Kd_again);
            EXPECT_TRUE(f == float_forces(again, m, x, other)) << name << ", " << count << " threads";
            EXPECT_TRUE(energy == again.energy(m, x, other)) << name << ", " << count << " threads";
            EXPECT_TRUE(Kd == Kd_again) << name << ", " << count << " threads";
        }
    }
}

TEST(CellBlocks, a_loose_tolerance_changes_little_and_keeps_linear_fields) {
    const Model m = beam();
    const CellBlocks exact(m, threads), loose(m, threads, {.tolerance = 1e-2});
    EXPECT_GE(loose.counts().uniform_chunks, 2 * exact.counts().uniform_chunks);
    EXPECT_LE(error_of(loose, m, turned_stretched_and_shaken(m)), 0.02);
    const auto x = affine(m, some_stretch());
    EXPECT_NEAR(loose.energy(m, x, threads) / exact.energy(m, x, threads), 1, 1e-5);
}

TEST(CellBlocks, deep_cells_share_their_gradients) {
    const Model m = thick_box();
    const CellBlocks blocks(m, threads);
    EXPECT_EQ(blocks.counts().groups, 1728u);
    EXPECT_GE(blocks.counts().uniform_chunks, 8u);
}

TEST(CellBlocks, cells_of_a_large_body_share_what_is_similar_and_take_a_quarter_less_memory) {
    const Model m = thick_box();
    const CellBlocks small(m, threads), large(m, threads, large_body);
    EXPECT_EQ(small.counts().similar_chunks, 0u);
    EXPECT_EQ(large.counts().uniform_chunks, small.counts().uniform_chunks);
    EXPECT_GE(2 * large.counts().similar_chunks, large.counts().chunks);
    EXPECT_LE(static_cast<double>(large.counts().bytes), 0.75 * static_cast<double>(small.counts().bytes));
}

}  // namespace
}  // namespace phyxel
