/// Bodies of several materials, from the outside.
#include <gtest/gtest.h>

#include "support/measured.h"
#include "support/temporary_directory.h"
#include "world/motion.h"

namespace phyxel {
namespace {

using test::TemporaryDirectory;

const Material soft = linear({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0});

Material times(Material material, double stiffness, double density = 1) {
    material.youngs_modulus *= stiffness;
    material.density *= density;
    return material;
}

/// Error of the stretch of a bar 20 x 20 x 200 mm whose upper part, from `cut` on, is `ratio` times as stiff: under a
/// force each part stretches for itself, u = F/A (l_1/E_1 + l_2/E_2).
double series_error(double spacing, double cut, double ratio) {
    World world({.time_step = 1, .gravity = {}, .integrator = Integrator::statics, .threads = 2});
    const BodyId bar = world.add_body(make_box({0.02, 0.02, 0.2}),
                                      {.translation = {0, 0, 0.1},
                                       .spacing = spacing,
                                       .material = soft,
                                       .regions = {{BoxRegion{{-1, -1, cut}, {1, 1, 1}}, times(soft, ratio)}}});
    world.add_fix(bar, {.box = {{-1, -1, 0}, {1, 1, 0}}});
    world.add_load(bar, {.box = {{-1, -1, 0.2}, {1, 1, 0.2}}, .force = Vec3{0, 0, 1}});
    const std::size_t tip = world.add_probe(bar, {0, 0, 0.2});
    const StepReport report = world.step();
    EXPECT_EQ(report.status, StepStatus::ok) << report.message;
    const double pressure = 1 / 4e-4, exact = pressure / soft.youngs_modulus * (cut + (0.2 - cut) / ratio);
    return (world.probe(tip).position.z - 0.2) / exact - 1;
}

TEST(Regions, two_materials_in_series_stretch_as_the_sum_of_both) {
    // The smooth field turns the kink at the border over a support, which costs about a quarter of a spacing of the
    // soft part at ten times the modulus, wherever in the lattice the border is; it falls with the spacing.
    double worst = 0;
    for (double cut : {0.1, 0.1025, 0.105, 0.107}) worst = std::max(worst, std::abs(series_error(0.01, cut, 10)));
    const double finer = std::abs(series_error(0.005, 0.1, 10));
    EXPECT_LE(worst, 0.03);
    EXPECT_LE(finer, 0.6 * std::abs(series_error(0.01, 0.1, 10)));
    EXPECT_LE(std::abs(series_error(0.01, 0.1, 1)), 1e-3) << "of one material";
    measured("stretch at 10 mm", worst);
    measured("stretch at 5 mm", finer);
}

TEST(Regions, weigh_what_their_density_says) {
    World world;
    BodySettings settings = small_body();
    settings.regions = {{BoxRegion{{-1, -1, -1}, {1, 0.02, 1}}, times(settings.material, 1, 5)}};
    const BodyId body = world.add_body(make_box({0.1, 0.1, 0.1}), settings);
    EXPECT_NEAR(world.report(body).mass, 0.7 * 5 + 0.3, 1e-12);
}

TEST(Regions, stiffest_and_lightest_part_sets_the_step) {
    const auto step = [](double stiffness, double density) {
        World world({.integrator = Integrator::leap_frog});
        BodySettings settings = small_body();
        if (stiffness != 1 || density != 1)
            settings.regions = {{BoxRegion{{-1, -1, -1}, {1, 0, 1}}, times(settings.material, stiffness, density)}};
        world.add_body(make_box({0.1, 0.1, 0.2}), settings);
        return world.stable_substep();
    };
    EXPECT_NEAR(step(100, 1) / step(1, 1), 0.1, 0.02);
    EXPECT_NEAR(step(1, 0.01) / step(1, 1), 0.1, 0.02);
    EXPECT_NEAR(step(0.01, 1) / step(1, 1), 1, 0.05);
}

TEST(Regions, that_hold_nothing_are_warned_about) {
    for (const BoxRegion& box : {BoxRegion{{5, 5, 5}, {6, 6, 6}}, BoxRegion{{0, 0, 0}, {0, 0, 0}}}) {
        World world;
        BodySettings settings = small_body();
        settings.regions = {{box, settings.material}};
        world.add_body(make_box({0.1, 0.1, 0.1}), settings);
        ASSERT_EQ(world.warnings().size(), 1u);
        EXPECT_NE(world.warnings()[0].message.find("region 0 holds no part of its body"), std::string::npos);
    }
}

TEST(Regions, that_are_wrong_are_refused_by_name) {
    const auto expect_refused = [](const std::string& field, Region region) {
        World world;
        BodySettings settings = small_body();
        settings.regions = {{SphereRegion{{}, 0.02}, settings.material}, std::move(region)};
        try {
            world.add_body(make_box({0.1, 0.1, 0.1}), settings);
            ADD_FAILURE() << field << ": accepted";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
        }
    };
    const Material jelly = small_body().material;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_refused("region 1.box", {BoxRegion{{1, 0, 0}, {0, 1, 1}}, jelly});
    expect_refused("region 1.box", {BoxRegion{{nan, 0, 0}, {0, 1, 1}}, jelly});
    expect_refused("region 1.sphere radius", {SphereRegion{{}, 0}, jelly});
    expect_refused("region 1.sphere", {SphereRegion{{nan, 0, 0}, 1}, jelly});
    expect_refused("region 1.transition", {SphereRegion{{}, 0.02}, jelly, -1});
    expect_refused("region 1: material: density", {SphereRegion{{}, 0.02}, times(jelly, 1, 0)});
    expect_refused("blend two laws", {SphereRegion{{}, 0.02}, corotated(jelly), 0.05});
    expect_refused("no inside", {TriangleMesh{}, jelly});
}

TEST(Regions, take_a_new_material_by_their_number) {
    World world;
    BodySettings settings = small_body();
    settings.regions = {{SphereRegion{{}, 0.03}, times(settings.material, 10, 2)}};
    const BodyId body = world.add_body(make_box({0.1, 0.1, 0.1}), settings);
    world.set_material(body, times(settings.regions[0].material, 2), 0);
    world.set_material(body, times(settings.material, 0.5));
    EXPECT_THROW(world.set_material(body, settings.material, 0), Error) << "another density";
    EXPECT_THROW(world.set_material(body, settings.material, 1), Error) << "there is one region";
    EXPECT_THROW(world.set_material(body, corotated(settings.material)), Error) << "blended with a neo-hookean one";
    EXPECT_EQ(world.step().status, StepStatus::ok);
}

/// A hanging jelly block, nearly incompressible, with a stiff core.
World with_core(Integrator integrator, int threads, double core_modulus = 1e6) {
    World world({.integrator = integrator, .threads = threads});
    BodySettings settings = small_body();
    settings.material.poissons_ratio = 0.49;
    settings.regions = {
        {SphereRegion{{}, 0.04}, {.density = 3000, .youngs_modulus = core_modulus, .poissons_ratio = 0.3}, 0.02}};
    const BodyId block = world.add_body(make_box({0.2, 0.2, 0.2}), settings);
    world.add_fix(block, {.box = {{-1, 0.1, -1}, {1, 0.1, 1}}});
    return world;
}

TEST(Regions, give_the_same_bits_for_any_number_of_threads) {
    for (Integrator integrator : {Integrator::leap_frog, Integrator::implicit_euler}) {
        const auto hash = [&](int threads) {
            World world = with_core(integrator, threads);
            for (int k = 0; k < 2; ++k) EXPECT_EQ(world.step().status, StepStatus::ok);
            return world.state_hash();
        };
        const std::uint64_t expected = hash(1);
        for (int threads : {2, 3, 8}) EXPECT_EQ(hash(threads), expected) << threads;
    }
}

TEST(Regions, checkpoint_of_another_mixture_is_refused) {
    const TemporaryDirectory folder;
    with_core(Integrator::leap_frog, 2).save_checkpoint(folder / "state");
    World same = with_core(Integrator::leap_frog, 1), other = with_core(Integrator::leap_frog, 2, 2e6);
    EXPECT_NO_THROW(same.load_checkpoint(folder / "state"));
    EXPECT_THROW(other.load_checkpoint(folder / "state"), Error);
}

}  // namespace
}  // namespace phyxel
