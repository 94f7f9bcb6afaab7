#include "forces/rest_stiffness.h"

#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "model/modelled.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

Model stiff_box() {
    BodySettings settings = turned(settings_of(all_schemes()[0]));
    settings.stabilization = 0.2;
    return modelled(make_box({1, 0.8, 0.6}), settings, 0.11);
}

std::vector<Vec3> approximate(const Model& m, std::span<const Vec3> d, const Threads& with) {
    std::vector<Vec3f> narrow, out(d.size());
    for (const Vec3& v : d) narrow.push_back(vector_cast<float>(v));
    RestStiffness(m, with).apply(m, narrow, with, out);
    std::vector<Vec3> result;
    for (const Vec3f& v : out) result.push_back(vector_cast<double>(v));
    return result;
}

std::vector<Vec3> exact(const Model& m, std::span<const Vec3> d) {
    std::vector<Vec3> out(d.size());
    ForceWorkspace work;
    stiffness_action(m, m.rest, d, work, threads, out);
    return out;
}

TEST(RestStiffness, stores_a_little_more_than_smooth_fields_do_and_at_least_half_in_any) {
    const Model m = stiff_box();
    std::vector<Vec3> bent;
    for (const Vec3& X : m.rest) bent.push_back({X.x * X.z, 0.3 * X.y * X.y, -0.5 * X.x * X.x});
    EXPECT_NEAR(inner(bent, approximate(m, bent, threads)) / inner(bent, exact(m, bent)), 1.15, 0.03);
    for (const unsigned seed : {1u, 2u, 3u}) {
        const std::vector<Vec3> rough = random_field(m.rest.size(), 1, seed);
        const double ratio = inner(rough, approximate(m, rough, threads)) / inner(rough, exact(m, rough));
        EXPECT_GT(ratio, 0.5);
        EXPECT_LT(ratio, 2);
    }
}

TEST(RestStiffness, is_symmetric_and_feels_no_translation) {
    const Model m = stiff_box();
    const auto a = random_field(m.rest.size(), 1, 1), b = random_field(m.rest.size(), 1, 2);
    const auto Ka = approximate(m, a, threads), Kb = approximate(m, b, threads);
    EXPECT_NEAR(inner(a, Kb), inner(b, Ka), 1e-5 * inner(a, Ka));
    const auto moved = approximate(m, std::vector<Vec3>(m.rest.size(), {1, 2, 3}), threads);
    EXPECT_LE(largest(moved), 1e-5 * largest(Ka));
}

TEST(RestStiffness, is_the_same_for_any_number_of_threads) {
    const Model m = stiff_box();
    const auto d = random_field(m.rest.size(), 1, 3);
    const auto Kd = approximate(m, d, Threads(1));
    for (const int count : {2, 3, 8}) EXPECT_EQ(Kd, approximate(m, d, Threads(count))) << count << " threads";
}

}  // namespace
}  // namespace phyxel
