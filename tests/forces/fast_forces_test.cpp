#include "forces/fast_forces.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/modelled.h"
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

TEST(FastForces, are_the_same_for_any_number_of_threads) {
    const Model m = turned_box(0.2);
    const auto x = turned_stretched_and_shaken(m);
    const auto forces = [&](const Threads& with) {
        std::vector<Vec3> f(x.size());
        FastForces(m, CellBlocks(m, with)).forces(m, x, with, f);
        return f;
    };
    const auto f = forces(Threads(1));
    for (const int count : {2, 3, 8}) EXPECT_EQ(f, forces(Threads(count))) << count << " threads";
}

}  // namespace
}  // namespace phyxel
