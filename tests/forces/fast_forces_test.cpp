#include "forces/fast_forces.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/modelled.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

std::vector<Vec3f> in_float(std::span<const Vec3> v) {
    std::vector<Vec3f> result;
    for (const Vec3& a : v) result.push_back(vector_cast<float>(a));
    return result;
}

std::vector<Vec3f> rest_times(const Model& m, std::span<const Vec3> d, const Threads& with) {
    std::vector<Vec3f> out(d.size());
    FastForces(m, CellBlocks(m, with)).rest_action(m, in_float(d), with, out);
    return out;
}

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
        fast.forces(m, x, threads, f);
        EXPECT_LE(largest_difference(f, exact), 1e-5 * largest(exact));
        const double energy = elastic_energy(m, x, work, threads) + stabilization_energy(m, x, work, threads);
        EXPECT_NEAR(fast.energy(m, x, threads) / energy, 1, 1e-6);
    }
}

TEST(FastForces, rest_action_is_the_stiffness_action_at_rest) {
    const Model m = turned_box(0.2);
    const auto d = random_field(m.rest.size(), 1, 3);
    std::vector<Vec3> exact(d.size()), found;
    ForceWorkspace work;
    stiffness_action(m, m.rest, d, work, threads, exact);
    for (const Vec3f& v : rest_times(m, d, threads)) found.push_back(vector_cast<double>(v));
    EXPECT_LE(largest_difference(found, exact), 1e-5 * largest(exact));
}

TEST(FastForces, are_the_same_for_any_number_of_threads) {
    const Model m = turned_box(0.2);
    const auto x = turned_stretched_and_shaken(m), d = random_field(m.rest.size(), 1, 3);
    const auto forces = [&](const Threads& with) {
        std::vector<Vec3> f(x.size());
        FastForces(m, CellBlocks(m, with)).forces(m, x, with, f);
        return f;
    };
    const auto f = forces(Threads(1));
    const auto Kd = rest_times(m, d, Threads(1));
    for (const int count : {2, 3, 8}) {
        EXPECT_EQ(f, forces(Threads(count))) << count << " threads";
        EXPECT_EQ(Kd, rest_times(m, d, Threads(count))) << count << " threads";
    }
}

}  // namespace
}  // namespace phyxel
