#include <gtest/gtest.h>

#include <cmath>

#include "reference/thesis_2008.h"
#include "solver/dynamics.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

Model small_box(const Scheme& scheme, Law law = Law::neo_hookean) {
    BodySettings settings = turned(settings_of(scheme));
    settings.material.law = law;
    return modelled(make_box({1, 0.8, 0.6}), settings, equal_spacing(scheme, 0.3));
}

/// Twists and swells fast enough for strains of a fifth.
void set_swinging(DynamicBody& body, double speed = 8) {
    for (std::size_t i = 0; i < body.state.v.size(); ++i) {
        const Vec3& X = body.model.rest[i];
        body.state.v[i] = speed * Vec3{0.3 * X.x, -X.z * X.x, X.y * X.x};
    }
}

double crossing_time(const Model& m) {
    return m.node_length / pressure_wave_speed(m.material.lame, m.settings.density);
}

TEST(Motion, follows_the_thesis_listing) {
    // Whole cells, points at nodes, no stabilization, no correction: the listing, corrected.
    constexpr double a = 0.1, k_v = 3e5;
    BodySettings settings = settings_of(all_schemes()[2]);
    settings.stabilization = 0;
    settings.consistency_correction = false;
    settings.material.law = Law::saint_venant_kirchhoff;
    settings.material.volume_stiffness = k_v;
    const auto body = body_of(whole_cell_model({4, 5, 3}, a, settings));
    const Model& m = body->model;
    set_swinging(*body);
    Surroundings around;
    around.gravity = {0, -9.81, 0};

    const reference::Body listing = {
        m.rest, m.mass,        m.volumes, m.approximation.support, m.material.lame.lambda, m.material.lame.mu,
        k_v,    around.gravity};
    const double dt = 0.3 * crossing_time(m);
    reference::State expected = reference::start(listing, std::vector<Vec3>(m.rest.size()), body->state.v, dt);
    leap_frog(*body, around, 0, dt, 60, threads);
    for (int step = 0; step < 60; ++step) reference::leap_frog_step(listing, expected, dt);

    std::vector<Vec3> moved;
    for (std::size_t i = 0; i < m.rest.size(); ++i) moved.push_back(m.rest[i] + expected.u[i]);
    const double error = largest_difference(body->state.x, moved) / largest(expected.u);
    EXPECT_GT(largest(expected.u), 0.3 * a);
    EXPECT_LE(error, 1e-12);
    measured("against the listing", error);
}

TEST(Motion, leap_frog_and_verlet_take_the_same_path) {
    for (const Scheme& scheme : all_schemes()) {
        const auto frog = body_of(small_box(scheme)), verl = body_of(small_box(scheme));
        set_swinging(*frog), set_swinging(*verl);
        Surroundings around;
        around.gravity = {0, -9.81, 0};
        const double dt = 0.3 * crossing_time(frog->model);
        leap_frog(*frog, around, 0, dt, 300, threads);
        verlet(*verl, around, 0, dt, 300, threads);
        EXPECT_LE(largest_difference(frog->state.x, verl->state.x), 1e-11) << scheme.name;
        EXPECT_LE(largest_difference(frog->state.v, verl->state.v), 1e-9) << scheme.name;
        EXPECT_GT(largest_difference(frog->state.x, frog->model.rest), 0.05) << scheme.name;
    }
}

TEST(Motion, keeps_linear_and_angular_momentum) {
    for (const Scheme& scheme : all_schemes()) {
        const auto body = body_of(small_box(scheme));
        set_swinging(*body);
        for (Vec3& v : body->state.v) v += Vec3{1, 2, 3};
        const auto momenta = [&] {
            std::pair<Vec3, Vec3> sum;
            for (std::size_t i = 0; i < body->state.x.size(); ++i) {
                sum.first += body->model.mass[i] * body->state.v[i];
                sum.second += body->model.mass[i] * cross(body->state.x[i], body->state.v[i]);
            }
            return sum;
        };
        const auto before = momenta();
        leap_frog(*body, {}, 0, 0.3 * crossing_time(body->model), 1000, threads);
        const auto after = momenta();
        EXPECT_LE(norm(after.first - before.first), 1e-12 * norm(before.first)) << scheme.name;
        EXPECT_LE(norm(after.second - before.second), 1e-11 * norm(before.first)) << scheme.name;
    }
}

/// How far the mean energy of the last tenth of about `steps` substeps, as a world takes them, is from that of the
/// first, relatively. (Energy itself swings by (omega dt)^2/8 of what is in each mode, as it does for any step of an
/// integrator that conserves it in the mean.)
double energy_drift(const Scheme& scheme, double speed, std::size_t steps) {
    std::vector<std::unique_ptr<DynamicBody>> bodies;
    bodies.push_back(body_of(small_box(scheme)));
    set_swinging(*bodies[0], speed);
    estimate_rest_step(*bodies[0], {}, threads);
    std::vector<double> energies;
    double time = 0;
    for (std::size_t taken = 0; taken < steps;) {
        const double duration = 10 * bodies[0]->rest_step;
        const StepReport report = advance(bodies, {}, Integrator::leap_frog, time, duration, threads);
        EXPECT_EQ(report.status, StepStatus::ok) << scheme.name;
        taken += report.substeps, time += duration;
        energies.push_back(total_energy(*bodies[0]));
    }
    const std::size_t tenth = energies.size() / 10;
    double first = 0, last = 0;
    for (std::size_t k = 0; k < tenth; ++k) first += energies[k], last += energies[energies.size() - 1 - k];
    return last / first - 1;
}

constexpr double brisk = 2;  ///< [m/s] for `set_swinging`: strains of a twentieth

TEST(Motion, energy_drifts_by_less_than_one_percent_in_two_thousand_steps) {
    for (const Scheme& scheme : all_schemes()) {
        const double drift = energy_drift(scheme, brisk, 2000);
        EXPECT_LE(std::abs(drift), 0.01) << scheme.name;
        measured(scheme.name, drift);
    }
}

TEST(Motion, LONG_energy_drifts_by_less_than_one_percent_in_a_hundred_thousand_steps) {
    for (const Scheme& scheme : all_schemes()) {
        const double drift = energy_drift(scheme, brisk, 100000);
        EXPECT_LE(std::abs(drift), 0.01) << scheme.name;
        measured(scheme.name, drift);
    }
}

TEST(Damping, of_mass_slows_rigid_motion_by_exactly_the_exponential_at_any_step) {
    Surroundings around;
    around.mass_damping = 3;
    const Vec3 v = {1, -2, 0.5};
    for (const std::size_t steps : {3u, 40u, 1000u}) {
        const auto body = body_of(small_box(all_schemes()[0]));
        body->state.v.assign(body->state.v.size(), v);
        const double seconds = 3e-3;
        leap_frog(*body, around, 0, seconds / double(steps), steps, threads);
        for (const Vec3& found : body->state.v) EXPECT_LE(norm(found - std::exp(-3 * seconds) * v), 1e-12) << steps;
    }
}

/// Decay rate [1/s] of the amplitude of a body's lowest elastic mode under `around`, at steps of `dt`.
double decay_rate(const Model& m, const Surroundings& around, std::span<const Vec3> mode, double omega, double dt) {
    const auto body = body_of(m);
    const double speed = 1e-3 * m.node_length * omega;
    for (std::size_t i = 0; i < mode.size(); ++i) body->state.v[i] = speed * mode[i];
    const double start = total_energy(*body);
    // Whole periods of the damped swing, so that the energy is all kinetic again.
    const double seconds = 6 * 2 * std::acos(-1) / omega;
    const auto steps = static_cast<std::size_t>(std::ceil(seconds / dt));
    leap_frog(*body, around, 0, seconds / double(steps), steps, threads);
    return 0.5 * std::log(start / total_energy(*body)) / seconds;
}

TEST(Damping, of_a_mode_is_that_of_rayleigh_and_does_not_depend_on_the_step) {
    for (const Scheme& scheme : {all_schemes()[0], all_schemes()[2]}) {
        const Model m = small_box(scheme, Law::corotated);
        const auto [omega, mode] = lowest_elastic_mode(m);
        Surroundings mass, stiffness;
        mass.mass_damping = 0.06 * omega;
        stiffness.stiffness_damping = 0.06 / omega;
        const double expected = 0.03 * omega;  // alpha/2 and beta omega^2/2
        for (const double share : {0.6, 0.1}) {
            const double dt = share * stable_step(largest_frequency(m), stiffness.stiffness_damping);
            const double by_mass = decay_rate(m, mass, mode, omega, dt) / expected;
            const double by_stiffness = decay_rate(m, stiffness, mode, omega, dt) / expected;
            EXPECT_NEAR(by_mass, 1, 2e-3) << scheme.name << " " << share;
            // Viscous forces go by the velocity of half a step ago: first order in the step.
            EXPECT_NEAR(by_stiffness, 1, 1e-2 * share) << scheme.name << " " << share;
            measured(scheme.name + ", rate by mass", by_mass);
            measured(scheme.name + ", rate by stiffness", by_stiffness);
        }
    }
}

/// Pulls on the right face of a bar until it rests, its left face held in the directions given.
struct Pulled {
    std::unique_ptr<DynamicBody> body;
    Reaction reaction;
};

Pulled pull(const BodySettings& settings, const Fix& fix, const Vec3& force) {
    constexpr BoxSelection right_face = {{0.499, -1, -1}, {1, 1, 1}};
    const TriangleMesh mesh = make_box({1, 0.6, 0.6});
    Pulled pulled{body_of(modelled(mesh, settings, 0.2)), {}};
    DynamicBody& body = *pulled.body;
    const std::size_t held = body.constraints.add(body.model, mesh, fix, threads);
    body.loads.emplace_back(body.model, mesh, Load{.box = right_face, .force = force}, threads);
    Surroundings around;
    around.mass_damping = 60;
    estimate_rest_step(body, around, threads);
    leap_frog(body, around, 0, body.rest_step, 2000, threads);
    body.constraints.start_measuring();
    leap_frog(body, around, 0, body.rest_step, 10, threads);
    pulled.reaction = body.constraints.reaction(held, 10 * body.rest_step);
    return pulled;
}

TEST(Equilibrium, reaction_equals_the_load_and_its_torque) {
    const Vec3 force = {300, -100, 50};
    for (const Scheme& scheme : {all_schemes()[0], all_schemes()[2]})
        for (const bool aligned : {true, false}) {
            const BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
            const Pulled p = pull(settings, {.box = {{-1, -1, -1}, {-0.499, 1, 1}}}, force);
            EXPECT_LE(norm(p.reaction.force + force), 1e-4 * norm(force)) << scheme.name << aligned;
            // About the middle of the held face; the loaded face has moved there from a distance of one metre.
            Vec3 end{};
            std::vector<Vec3> load(p.body->state.x.size());
            p.body->loads[0].add(0, p.body->state.x, load);
            for (std::size_t i = 0; i < load.size(); ++i) end += cross(p.body->state.x[i] - Vec3{-0.5, 0, 0}, load[i]);
            EXPECT_LE(norm(p.reaction.torque + end), 2e-2 * norm(end)) << scheme.name << aligned;
            measured(scheme.name + (aligned ? ", aligned, torque" : ", turned, torque"),
                     norm(p.reaction.torque + end) / norm(end));
        }
}

TEST(Equilibrium, rollers_take_no_force_along_their_directions) {
    const Pulled p = pull(settings_of(all_schemes()[0]),
                          {.box = {{-1, -1, -1}, {-0.499, 1, 1}}, .x = true, .y = false, .z = false}, {300, 0, 0});
    EXPECT_NEAR(p.reaction.force.x, -300, 0.03);
    EXPECT_EQ(p.reaction.force.y, 0);
    EXPECT_EQ(p.reaction.force.z, 0);
    // The held face shrinks sideways as the rest of the bar does, but for the 6 % by which nodes held in its plane miss
    // a uniform reaction: the face's own nodes do not carry its whole field.
    double half_width = 0;
    for (std::size_t i = 0; i < p.body->state.x.size(); ++i)
        if (p.body->model.rest[i].x < -0.499) half_width = std::max(half_width, p.body->state.x[i].y);
    const double strain = 300 / (0.6 * 0.6) / 1e6;
    EXPECT_NEAR(half_width / 0.3 - 1, -0.3 * strain, 0.1 * 0.3 * strain);
}

}  // namespace
}  // namespace phyxel
