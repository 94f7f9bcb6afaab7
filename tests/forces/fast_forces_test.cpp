#include "forces/fast_forces.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/all_laws.h"
#include "model/modelled.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

Model turned_box(double stabilization) {
    BodySettings settings = turned(settings_of(all_schemes()[0]));
    settings.stabilization = stabilization;
    return modelled(make_box({1, 0.8, 0.6}), settings, 0.22);
}

TEST(FastForces, are_those_in_double_precision_with_stabilization) {
    for (const double stabilization : {0.2, 0.0}) {
        const Model m = turned_box(stabilization);
        const auto x = turned_stretched_and_shaken(m);
        std::vector<Vec3> exact(x.size()), f(x.size());
        ForceWorkspace work;
        internal_forces(m, x, {}, 0, work, threads, exact);
        FastForces fast(m, CellBlocks(m, threads));
        const double with_forces = fast.forces(m, x, threads, f);
        EXPECT_LE(largest_difference(f, exact), 1e-5 * largest(exact));
        const double energy = elastic_energy(m, x, work, threads) + stabilization_energy(m, x, work, threads);
        EXPECT_NEAR(fast.energy(m, x, threads) / energy, 1, 1e-6);
        EXPECT_EQ(fast.energy(m, x, threads), with_forces);
    }
}

TEST(FastForces, damped_ones_are_those_in_double_precision) {
    constexpr double beta = 0.3;
    double worst = 0;
    for (const double poissons_ratio : {0.3, 0.49})  // the latter shares its dilatation
        for (const auto& [law, material] : all_laws()) {
            BodySettings settings = turned(settings_of(all_schemes()[0]));
            settings.stabilization = 0.2;
            settings.material = material;
            settings.material.poissons_ratio = poissons_ratio;
            const Model m = modelled(make_box({1, 0.8, 0.6}), settings, 0.22);
            const auto x = turned_stretched_and_shaken(m), v = random_field(x.size(), 0.2, 3);
            std::vector<Vec3> exact(x.size()), elastic(x.size()), f(x.size());
            ForceWorkspace work;
            internal_forces(m, x, v, beta, work, threads, exact);
            internal_forces(m, x, {}, 0, work, threads, elastic);
            for (const std::size_t cached : {CellOptions{}.cached_gradients, std::size_t{0}}) {
                FastForces fast(m, CellBlocks(m, threads, {.cached_gradients = cached}));
                fast.damped_forces(m, x, v, beta, threads, f);
                EXPECT_LE(largest_difference(f, exact), 1e-5 * largest(exact)) << law;
                worst = std::max(worst, largest_difference(f, exact) / largest(exact));
            }
            EXPECT_GE(largest_difference(exact, elastic), 0.1 * largest(elastic)) << law;
        }
    measured("damped force against double precision", worst);
}

TEST(FastForces, of_a_body_that_turns_have_no_viscous_part) {
    const Model m = turned_box(0.2);
    const Mat3 turn = rotation_about(normalized(Vec3{1, 1, 0}), 1.2);
    const Vec3 spin{3, -2, 5};
    std::vector<Vec3> x, v, elastic(m.rest.size()), damped(m.rest.size());
    for (const Vec3& X : m.rest) {
        x.push_back(turn * X + Vec3{100, -50, 20});
        v.push_back(cross(spin, x.back()) + Vec3{10, 20, 30});
    }
    FastForces fast(m, CellBlocks(m, threads));
    fast.forces(m, x, threads, elastic);
    fast.damped_forces(m, x, v, 0.3, threads, damped);
    EXPECT_LE(largest_difference(damped, elastic), 2e-5 * m.settings.youngs_modulus * m.node_length * m.node_length);
}

TEST(FastForces, are_the_same_for_any_number_of_threads) {
    const Model m = turned_box(0.2);
    const auto x = turned_stretched_and_shaken(m), v = random_field(x.size(), 0.2, 3);
    const auto forces = [&](const Threads& with) {
        std::vector<Vec3> f(x.size());
        FastForces fast(m, CellBlocks(m, with));
        fast.forces(m, x, with, f);
        std::vector<Vec3> damped(x.size());
        fast.damped_forces(m, x, v, 0.3, with, damped);
        f.insert(f.end(), damped.begin(), damped.end());
        return f;
    };
    const auto f = forces(Threads(1));
    for (const int count : {2, 3, 8}) EXPECT_EQ(f, forces(Threads(count))) << count << " threads";
}

}  // namespace
}  // namespace phyxel
