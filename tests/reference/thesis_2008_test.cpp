#include "reference/thesis_2008.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace phyxel::reference {
namespace {

constexpr double spacing = 0.1;  // [m]
constexpr double density = 1000;

/// A block of n x n x (n + 1) nodes that own whole cells; nu = 0.25, so that lambda = mu.
Body block(std::size_t n) {
    Body body;
    for (std::size_t x = 0; x < n; ++x)
        for (std::size_t y = 0; y < n; ++y)
            for (std::size_t z = 0; z <= n; ++z) body.X.push_back(spacing * Vec3{double(x), double(y), double(z)});
    const double cell = spacing * spacing * spacing;
    body.volume.assign(body.X.size(), cell);
    body.mass.assign(body.X.size(), density * cell);
    body.support = 1.8 * spacing;
    body.lambda = body.mu = 4e4;
    return body;
}

/// Turned by one radian and shaken by a tenth of the spacing.
std::vector<Vec3> turned_and_shaken(const Body& body) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shake(-0.1 * spacing, 0.1 * spacing);
    const Mat3 Q = rotation_about(normalized(Vec3{1, 2, -1}), 1.0);
    std::vector<Vec3> u;
    for (const Vec3& X : body.X) u.push_back(Q * X - X + Vec3{shake(random), shake(random), shake(random)});
    return u;
}

double largest(const std::vector<Vec3>& f) {
    double size = 0;
    for (const Vec3& force : f) size = std::max(size, norm(force));
    return size;
}

/// Largest difference between `f` and `scale` times `g`, relative to the largest force.
double difference(const std::vector<Vec3>& f, double scale, const std::vector<Vec3>& g) {
    double worst = 0;
    for (std::size_t i = 0; i < f.size(); ++i) worst = std::max(worst, norm(f[i] - scale * g[i]));
    return worst / largest(f);
}

/// The negative gradient of the energy by central differences of fourth order.
std::vector<Vec3> forces_by_differences(const Body& body, std::vector<Vec3> u) {
    const double step = 1e-3 * spacing;
    std::vector<Vec3> f(u.size());
    for (std::size_t i = 0; i < u.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = u[i][axis];
            const auto energy = [&](double shift) {
                u[i][axis] = at + shift;
                return elastic_energy(body, u);
            };
            const double near = energy(step) - energy(-step), far = energy(2 * step) - energy(-2 * step);
            f[i][axis] = -(8 * near - far) / (12 * step);
            u[i][axis] = at;
        }
    return f;
}

Vec3 net_force(const std::vector<Vec3>& f) { return std::accumulate(f.begin(), f.end(), Vec3{}); }

Vec3 net_torque(const Body& body, const std::vector<Vec3>& u, const std::vector<Vec3>& f) {
    Vec3 torque;
    for (std::size_t i = 0; i < f.size(); ++i) torque += cross(body.X[i] + u[i], f[i]);
    return torque;
}

TEST(Thesis2008, forces_are_the_negative_gradient_of_the_energy) {
    Body body = block(3);
    const std::vector<Vec3> u = turned_and_shaken(body);
    EXPECT_LE(difference(internal_forces(body, u), 1, forces_by_differences(body, u)), 1e-7);
    body.volume_stiffness = 1e5;
    EXPECT_LE(difference(internal_forces(body, u), 1, forces_by_differences(body, u)), 1e-7);
}

TEST(Thesis2008, net_force_and_torque_vanish) {
    Body body = block(4);
    body.volume_stiffness = 1e5;
    const std::vector<Vec3> u = turned_and_shaken(body), f = internal_forces(body, u);
    EXPECT_LE(norm(net_force(f)), 1e-13 * largest(f));
    EXPECT_LE(norm(net_torque(body, u, f)), 1e-13 * largest(f));
}

TEST(Thesis2008, rigid_motion_pulls_nothing_and_affine_motion_is_met_exactly) {
    const Body body = block(3);
    const Mat3 Q = rotation_about(normalized(Vec3{1, 2, -1}), 1.0);
    const Mat3 F = Q * Mat3{{{1.2, 0.3, 0}, {0, 0.9, 0.1}, {-0.2, 0, 1.1}}};
    std::vector<Vec3> turned, strained;
    for (const Vec3& X : body.X) {
        turned.push_back(Q * X - X + Vec3{5, 6, 7});
        strained.push_back(F * X - X);
    }
    EXPECT_LE(largest(internal_forces(body, turned)), 1e-12 * body.mu * spacing * spacing);
    for (std::size_t i = 0; i < body.X.size(); ++i) EXPECT_LE(norm(jacobian(body, strained, i) - F), 1e-13);
}

TEST(Thesis2008, printed_force_is_twice_the_gradient_and_four_times_without_the_half) {
    const Body body = block(3);
    const std::vector<Vec3> u = turned_and_shaken(body), f = internal_forces(body, u);
    EXPECT_LE(difference(internal_forces(body, u, {.twofold_force = true}), 2, f), 1e-15);
    EXPECT_LE(difference(internal_forces(body, u, {.strain_without_half = true}), 2, f), 1e-14);
    EXPECT_LE(difference(internal_forces(body, u, {.strain_without_half = true, .twofold_force = true}), 4, f), 1e-14);
}

TEST(Thesis2008, printed_order_of_stress_and_gradient_turns_a_rotated_body) {
    const Body body = block(3);
    const std::vector<Vec3> u = turned_and_shaken(body);
    const std::vector<Vec3> right = internal_forces(body, u);
    const std::vector<Vec3> printed = internal_forces(body, u, {.stress_before_gradient = true});
    EXPECT_GT(difference(printed, 1, right), 0.2);
    EXPECT_GT(norm(net_torque(body, u, printed)), 0.01 * spacing * largest(printed));
    EXPECT_LE(norm(net_torque(body, u, right)), 1e-13 * largest(right));
}

TEST(Thesis2008, printed_volume_force_lacks_the_volume_and_has_the_opposite_sign) {
    Body body = block(3);
    body.lambda = body.mu = 0;
    body.volume_stiffness = 1e5;
    const std::vector<Vec3> u = turned_and_shaken(body), right = internal_forces(body, u);
    EXPECT_LE(difference(right, -body.volume.front(), internal_forces(body, u, {.volume_force = true})), 1e-15);
}

TEST(Thesis2008, free_fall_is_exact_and_the_printed_update_is_off_by_the_mass) {
    Body body = block(2);
    body.gravity = {0, -9.81, 0};
    body.mass.assign(body.X.size(), 0.5);
    const double dt = 1e-3, seconds = 0.1;
    const auto fall = [&](const Misprints& misprints) {
        State state = start(body, std::vector<Vec3>(body.X.size()), std::vector<Vec3>(body.X.size()), dt);
        for (int step = 0; step < 100; ++step) leap_frog_step(body, state, dt, misprints);
        return state.u.front().y;
    };
    EXPECT_NEAR(fall({}), -0.5 * 9.81 * seconds * seconds, 1e-13);
    EXPECT_NEAR(fall({.position_over_mass = true}) / fall({}), 1 / body.mass.front(), 1e-12);
}

/// Largest deviation of the total energy over a quarter of a second of a block set swinging, relative to its kinetic
/// energy at 0.
double energy_drift(double volume_stiffness, double dt) {
    Body body = block(3);
    body.volume_stiffness = volume_stiffness;
    const std::vector<Vec3> u(body.X.size());
    std::vector<Vec3> v;
    for (const Vec3& X : body.X) v.push_back(Vec3{X.y - 1.5 * X.z, X.z, -X.x * X.z / spacing});
    State state = start(body, u, v, dt);
    const double at_start = total_energy(body, state, dt);
    double worst = 0;
    for (int step = 0; step < int(std::lround(0.25 / dt)); ++step) {
        leap_frog_step(body, state, dt);
        worst = std::max(worst, std::abs(total_energy(body, state, dt) - at_start));
    }
    return worst / at_start;
}

TEST(Thesis2008, trajectories_conserve_energy_to_second_order_in_the_step) {
    const double coarse = energy_drift(0, 1e-3), fine = energy_drift(0, 5e-4);
    EXPECT_LE(coarse, 1e-2);
    EXPECT_NEAR(coarse / fine, 4, 0.6);
    EXPECT_LE(energy_drift(5e4, 1e-3), 1e-2);
}

TEST(Thesis2008, printed_masses_volumes_and_supports_are_off) {
    Body body = block(6);
    const double mesh_volume = std::accumulate(body.volume.begin(), body.volume.end(), 0.0);
    const double printed_total = double(body.X.size()) * printed_mass(density, body.support);
    EXPECT_GT(printed_total, 10 * density * mesh_volume);

    const std::vector<double> volumes = printed_volumes(body);
    EXPECT_GT(std::accumulate(volumes.begin(), volumes.end(), 0.0), 1.1 * mesh_volume);

    // Nine nearest on a lattice: six at one spacing and three at sqrt(2) inside, farther at a corner.
    const std::vector<double> supports = printed_supports(body.X);
    EXPECT_NEAR(*std::min_element(supports.begin(), supports.end()), (6 + 3 * std::sqrt(2)) / 9 * spacing, 1e-15);
    EXPECT_LT(*std::min_element(supports.begin(), supports.end()), std::sqrt(2) * spacing);
}

TEST(Thesis2008, poly6_integrates_to_one) {
    const double h = 0.7;
    const int n = 2000;
    double sum = 0;
    for (int k = 0; k < n; ++k) {
        const double r = (k + 0.5) * h / n;
        sum += 4 * std::numbers::pi * r * r * poly6(r, h) * h / n;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_EQ(poly6(h, h), 0);
}

}  // namespace
}  // namespace phyxel::reference
