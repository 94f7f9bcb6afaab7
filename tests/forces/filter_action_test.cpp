#include "forces/filter_action.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/modelled.h"

namespace phyxel {
namespace {

std::vector<Vec3f> in_float(std::span<const Vec3> v) {
    std::vector<Vec3f> result;
    for (const Vec3& a : v) result.push_back(vector_cast<float>(a));
    return result;
}

std::vector<Vec3f> filter_times(const Model& m, std::span<const Vec3> d, const Threads& threads) {
    std::vector<Vec3f> out(d.size());
    FilterAction(m).add(in_float(d), threads, out);
    return out;
}

Model turned_box(double stabilization) {
    BodySettings settings = turned(settings_of(all_schemes()[0]));
    settings.stabilization = stabilization;
    return modelled(make_box({1, 0.8, 0.6}), settings, 0.15);
}

TEST(FilterAction, is_the_stabilizations_part_of_the_stiffness_action) {
    const Threads threads(2);
    const Model with = turned_box(0.2), without = turned_box(0);
    const auto d = random_field(with.rest.size(), 1, 3);
    std::vector<Vec3> all(d.size()), elastic(d.size()), filter;
    ForceWorkspace work;
    stiffness_action(with, with.rest, d, work, threads, all);
    stiffness_action(without, without.rest, d, work, threads, elastic);
    for (std::size_t i = 0; i < d.size(); ++i) all[i] -= elastic[i];
    for (const Vec3f& v : filter_times(with, d, threads)) filter.push_back(vector_cast<double>(v));
    EXPECT_LE(largest_difference(filter, all), 1e-5 * largest(all));
    EXPECT_EQ(filter_times(without, d, threads), std::vector<Vec3f>(d.size()));
}

TEST(FilterAction, ignores_linear_fields_far_away) {
    const Model m = turned_box(0.2);
    const auto d = affine(m, some_stretch(), {1e3, 0, 0}), random = random_field(d.size(), 1, 3);
    const Threads threads(2);
    float linear = 0, other = 0;
    for (const Vec3f& v : filter_times(m, d, threads)) linear = std::max(linear, norm(v));
    for (const Vec3f& v : filter_times(m, random, threads)) other = std::max(other, norm(v));
    EXPECT_LE(linear, 1e-3f * other);
}

TEST(FilterAction, is_the_same_for_any_number_of_threads) {
    const Model m = turned_box(0.2);
    const auto d = random_field(m.rest.size(), 1, 3);
    const auto once = filter_times(m, d, Threads(1));
    for (const int count : {2, 3, 8}) EXPECT_EQ(once, filter_times(m, d, Threads(count))) << count << " threads";
}

}  // namespace
}  // namespace phyxel
