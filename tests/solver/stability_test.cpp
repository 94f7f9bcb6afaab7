#include <gtest/gtest.h>

#include <algorithm>

#include "solver/dynamics.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

/// Whole and clipped bodies on all lattices and quadratures, for several ratios.
std::vector<NamedModel> bodies() {
    std::vector<NamedModel> all;
    for (const double nu : {0.0, 0.3, 0.49}) {
        const std::string ratio = ", nu " + std::to_string(nu).substr(0, 4);
        for (const Scheme& scheme : all_schemes()) {
            BodySettings settings = settings_of(scheme);
            settings.material.poissons_ratio = nu;
            const double a = equal_spacing(scheme, 0.25);
            all.push_back({scheme.name + ", box" + ratio, modelled(make_box({1, 0.8, 0.6}), settings, a)});
            all.push_back({scheme.name + ", sphere" + ratio, modelled(make_sphere(0.5), settings, a)});
            all.push_back({scheme.name + ", turned bunny" + ratio, modelled(unit_bunny(), turned(settings), a)});
        }
        BodySettings settings = settings_of(all_schemes()[2]);
        settings.material.poissons_ratio = nu;
        all.push_back({"whole cells" + ratio, whole_cell_model({5, 5, 5}, 0.2, settings)});
    }
    return all;
}

TEST(StableStep, true_limit_is_one_to_two_of_the_estimated_steps) {
    double least = 1e9, most = 0, least_spacing = 1e9, most_spacing = 0;
    for (NamedModel& c : bodies()) {
        const double limit = 2 / largest_frequency(c.model);
        const auto body = body_of(std::move(c.model));
        estimate_rest_step(*body, {}, threads);
        const double ratio = limit / body->rest_step;
        EXPECT_GE(ratio, 1.0) << c.name;
        EXPECT_LE(ratio, 2.0) << c.name;
        least = std::min(least, ratio), most = std::max(most, ratio);
        const Model& m = body->model;
        const double crossing = m.node_length / pressure_wave_speed(m.material.lame, m.settings.density);
        least_spacing = std::min(least_spacing, limit / crossing),
        most_spacing = std::max(most_spacing, limit / crossing);
    }
    measured("least ratio", least);
    measured("largest ratio", most);
    measured("least limit over a/c_p", least_spacing);
    measured("largest limit over a/c_p", most_spacing);
}

/// Largest energy in `steps` steps at `share` of the true limit over the energy at the start; linear law, undamped.
double growth(Model model, double share, std::size_t steps) {
    const double dt = share * 2 / largest_frequency(model);
    const auto body = body_of(std::move(model));
    body->state.v = random_field(body->state.x.size(), 0.01, 5);
    const double start = total_energy(*body);
    double most = 0;
    for (std::size_t k = 0; k < steps && most < 1e6 * start; k += 50) {
        leap_frog(*body, {}, 0, dt, 50, threads);
        most = std::max(most, total_energy(*body));
    }
    return most / start;
}

TEST(StableStep, two_percent_below_the_limit_stays_bounded_and_two_percent_above_blows_up) {
    for (const Scheme& scheme : all_schemes()) {
        BodySettings settings = turned(settings_of(scheme));
        settings.material.law = Law::linear;
        const Model m = modelled(make_box({1, 0.8, 0.6}), settings, equal_spacing(scheme, 0.25));
        const double below = growth(m, 0.98, 2000), above = growth(m, 1.02, 2000);
        EXPECT_LE(below, 30) << scheme.name;  // 1/(1 - 0.98^2): what the top mode's energy swings by at 0.98
        EXPECT_GT(above, 1e6) << scheme.name;
        measured(scheme.name + ", largest energy at 0.98", below);
        measured(scheme.name + ", at 1.02", above);
    }
}

TEST(StableStep, stiffness_damping_shortens_it_as_the_formula_says) {
    // Critical step of x'' + beta w^2 x' + w^2 x = 0 under leap-frog: (2/w) (sqrt(1 + xi^2) - xi).
    BodySettings settings = settings_of(all_schemes()[0]);
    settings.material.law = Law::linear;
    const Model m = modelled(make_box({1, 0.8, 0.6}), settings, 0.25);
    const double omega = largest_frequency(m);
    for (const double xi : {0.1, 0.5, 2.0}) {
        const double beta = 2 * xi / omega;
        EXPECT_NEAR(stable_step(omega, beta), 0.6 * 2 / omega * (std::sqrt(1 + xi * xi) - xi), 1e-12);
        Surroundings around;
        around.stiffness_damping = beta;
        const auto body = body_of(m);
        body->state.v = random_field(body->state.x.size(), 0.01, 5);
        const double start = total_energy(*body);
        leap_frog(*body, around, 0, stable_step(omega, beta), 2000, threads);
        EXPECT_LE(total_energy(*body), start) << xi;
    }
}

}  // namespace
}  // namespace phyxel
