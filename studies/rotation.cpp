#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "reference/brunet_2019.h"
#include "studies/results.h"

/// Brunet et al. 2019, equation 11, against the rotation of the deformation gradient F. As printed the rotation is that
/// of A = sum v (x_j - x_I) (X_j - X_I)^T, which is F times the moment of the neighbourhood: where that is no multiple
/// of the identity (at surfaces) a pure stretch along a slanted axis turns the frame, and the forces have no energy, so
/// that a body can be led around a closed path and give off work.

namespace phyxel::studies {
namespace {

using namespace reference::brunet;

constexpr double spacing = 0.01, support = 2.2 * spacing;

/// A bar of 2 x 2 x `cells` lattice cells, eight Gauss points in each.
Body make_bar(std::size_t cells) {
    const double E = 50e6, nu = 0.45;
    Body body{.X = {}, .points = {}, .lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), .mu = E / (2 * (1 + nu))};
    for (std::size_t k = 0; k <= cells; ++k)
        for (std::size_t j = 0; j <= 2; ++j)
            for (std::size_t i = 0; i <= 2; ++i) body.X.push_back(spacing * Vec3{double(i), double(j), double(k)});
    const auto at = [](std::size_t half) {
        return spacing * (double(half / 2) + 0.5 + (half % 2 ? 0.5 : -0.5) / std::sqrt(3.0));
    };
    for (std::size_t k = 0; k < 2 * cells; ++k)
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i)
                body.points.push_back(
                    moving_least_squares(body.X, {at(i), at(j), at(k)}, support, std::pow(spacing, 3) / 8));
    return body;
}

/// Largest angle [degrees] by which a stretch along axes between x and z, which turns nothing, turns a frame.
double false_rotation(const Body& body, double stretch, Rotation rotation) {
    double worst = 0;
    for (int k = 0; k < 12; ++k) {
        const double tilt = std::numbers::pi * k / 12;
        const Vec3 axis = {std::sin(tilt), 0, std::cos(tilt)};
        const Mat3 F = Mat3::identity() + (stretch - 1) * outer(axis, axis);
        std::vector<Vec3> x = body.X;
        for (Vec3& position : x) position = F * position;
        for (const Mat3& R : rotations(body, x, rotation))
            worst = std::max(worst, std::acos(std::clamp(0.5 * (trace(R) - 1), -1.0, 1.0)));
    }
    return 180 / std::numbers::pi * worst;
}

/// Work of the body's forces around a square of states, X + s d + t e, over the work of half the way.
double work_around_a_loop(const Body& body, double stretch, Rotation rotation) {
    const double amount = stretch - 1;
    const Mat3 slanted = amount * Mat3{{{0.3, 0.2, 0}, {0, -0.1, 0.3}, {0.3, 0, 0.2}}};
    std::mt19937 random(7);
    std::vector<Vec3> d(body.X.size()), e(body.X.size());
    for (std::size_t i = 0; i < d.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            d[i][axis] = amount * 0.2 * spacing * (2 * double(random()) / double(std::mt19937::max()) - 1);
        e[i] = slanted * body.X[i];
    }
    const int steps = 20;
    double sum = 0, forth = 0;
    for (int side = 0; side < 4; ++side)
        for (int k = 0; k < steps; ++k) {
            const double t = (k + 0.5) / steps;
            const double along_d = side == 0 ? t : side == 1 ? 1 : side == 2 ? 1 - t : 0;
            const double along_e = side == 0 ? 0 : side == 1 ? t : side == 2 ? 1 : 1 - t;
            std::vector<Vec3> x = body.X;
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += along_d * d[i] + along_e * e[i];
            const std::vector<Vec3> f = forces(body, x, rotation);
            double part = 0;
            for (std::size_t i = 0; i < x.size(); ++i) part += dot(f[i], side % 2 == 0 ? d[i] : e[i]);
            part *= (side < 2 ? 1.0 : -1.0) / steps;
            sum += part;
            if (side < 2) forth += part;
        }
    return std::abs(sum / forth);
}

}  // namespace

int run_rotation(const Options& options) {
    Results results("rotation", {"rotation", "stretch", "turned [deg]", "work of a loop"}, options);
    const Body body = make_bar(options.small ? 4 : 6);
    for (const Rotation rotation : {Rotation::printed, Rotation::of_deformation_gradient})
        for (const double stretch : {1.02, 1.05, 1.1, 1.2, 1.3, 1.5}) {
            const bool printed = rotation == Rotation::printed;
            const double turned = false_rotation(body, stretch, rotation);
            const double work = work_around_a_loop(body, stretch, rotation);
            results.add_row({printed ? "equation 11" : "of F", stretch, turned, work});
            results.note(turned), results.note(work);
            const std::string what =
                fmt::format("stretch {:g}, {}", stretch, printed ? "equation 11" : "rotation of F");
            if (printed) results.expect_at_least(what + ": turned [degrees]", turned, 10 * (stretch - 1));
            else results.expect_at_most(what + ": turned [degrees]", turned, 1e-5);
            if (printed && stretch > 1.15) results.expect_at_least(what + ": work of a loop", work, 1e-4);
            if (!printed) results.expect_at_most(what + ": work of a loop", work, 1e-3);
        }
    return results.finish();
}

}  // namespace phyxel::studies
