#include "solver/newton.h"

#include <algorithm>
#include <cmath>

#include "solver/nodal_vectors.h"

namespace phyxel {
namespace {

constexpr std::size_t most_linear = 2000;
constexpr double grown_too_much = 1000;  ///< residual over the first one
constexpr int most_shortenings = 10;

/// Conjugate gradients for K d = b at x, preconditioned. Negative curvature ends them with what there is.
class LinearSolver {
public:
    explicit LinearSolver(CoupledBodies& bodies) : bodies_(bodies), z_(bodies.size()), p_(z_), product_(z_) {}

    /// Writes the solution into `d`; `b` becomes the residual. Returns the number of iterations.
    std::size_t solve(const std::vector<Vec3>& x, double tolerance, std::vector<Vec3>& b, std::vector<Vec3>& d) {
        const Threads& threads = bodies_.threads;
        std::fill(d.begin(), d.end(), Vec3{});
        bodies_.precondition(b, z_);
        std::copy(z_.begin(), z_.end(), p_.begin());
        double rz = inner(b, z_, threads);
        const double enough = tolerance * tolerance * rz;
        for (std::size_t k = 0; k < most_linear; ++k) {
            if (!(rz > enough)) return k;
            bodies_.action(x, p_, product_);
            const double curvature = inner(p_, product_, threads);
            if (!(curvature > 0)) {
                if (k == 0) std::copy(p_.begin(), p_.end(), d.begin());
                return k + 1;
            }
            const double alpha = rz / curvature;
            add_scaled(d, alpha, p_, threads);
            add_scaled(b, -alpha, product_, threads);
            bodies_.precondition(b, z_);
            const double next = inner(b, z_, threads);
            const double beta = next / rz;
            threads.for_each(p_.size(), node_chunk, [&](std::size_t i) { p_[i] = z_[i] + beta * p_[i]; });
            rz = next;
        }
        return most_linear;
    }

private:
    CoupledBodies& bodies_;
    std::vector<Vec3> z_, p_, product_;
};

}  // namespace

void SolveReport::add(const SolveReport& other) {
    newton_iterations += other.newton_iterations;
    linear_iterations += other.linear_iterations;
    linear_worst = std::max(linear_worst, other.linear_worst);
    converged = other.converged;
    residual = other.residual;
    trouble = other.trouble;
}

SolveReport newton(CoupledBodies& bodies, std::vector<Vec3>& x, const SolveTolerance& tolerance, NewtonSteps steps,
                   int most) {
    const Threads& threads = bodies.threads;
    const std::size_t n = bodies.size();
    SolveReport report;
    LinearSolver linear(bodies);
    std::vector<Vec3> g(n), b(n), d(n), z(n);

    // The way of held components that are not where they belong.
    std::vector<Vec3> held = x;
    bodies.place_held(held);
    for (std::size_t i = 0; i < n; ++i) held[i] -= x[i];
    bool lift = inner(held, held, threads) > 0;

    double first = 0, last = 0;  // residuals: the larger of the first two, and the one before
    int growing = 0;
    bodies.gradient(x, g);
    for (int k = 0;; ++k) {
        report.residual = std::sqrt(inner(g, g, threads));
        if (!std::isfinite(report.residual)) {
            report.trouble = "the forces left the numbers";
            return report;
        }
        if (!lift) {
            // Done, or on the way, or not.
            if (report.residual <= tolerance.force) return report.converged = true, report;
            if (tolerance.energy > 0) {
                bodies.precondition(g, z);
                if (bodies.distance(g, z) <= tolerance.energy) return report.converged = true, report;
            }
            // The first step of a bending body leaves far larger forces than it began with, by the turning it brings.
            if (report.newton_iterations <= 1) first = std::max(first, report.residual);
            growing = report.newton_iterations > 1 && report.residual > last ? growing + 1 : 0;
            last = report.residual;
            if (report.residual > grown_too_much * first || growing >= 3) {
                report.trouble = "Newton's method diverged";
                return report;
            }
        }
        if (k == most) {
            report.trouble = "Newton's method did not converge in " + std::to_string(most) + " iterations";
            return report;
        }

        // K d = -g - K h over the free components.
        bodies.turn(x);
        bodies.support(x);
        if (lift) {
            bodies.action(x, held, b);
            threads.for_each(n, node_chunk, [&](std::size_t i) { b[i] = -g[i] - b[i]; });
            first = std::max(first, std::sqrt(inner(b, b, threads)));
        } else {
            threads.for_each(n, node_chunk, [&](std::size_t i) { b[i] = -g[i]; });
        }
        const std::size_t iterations = linear.solve(x, tolerance.linear, b, d);
        ++report.newton_iterations;
        report.linear_iterations += iterations;
        report.linear_worst = std::max(report.linear_worst, iterations);

        if (lift) add_scaled(d, 1.0, held, threads);
        const double slope = inner(g, d, threads);
        add_scaled(x, 1.0, d, threads);
        bodies.gradient(x, g);
        if (steps == NewtonSteps::guarded && !lift) {
            double length = 1;
            for (int s = 0; s < most_shortenings; ++s) {
                const double now = inner(g, d, threads);
                if (std::isfinite(now) && now <= 0.5 * std::abs(slope)) break;
                const double secant = std::isfinite(now) && slope < 0 ? slope / (slope - now) : 0.25;
                const double shorter = length * std::clamp(secant, 0.1, 0.7);
                add_scaled(x, shorter - length, d, threads);
                length = shorter;
                bodies.gradient(x, g);
            }
        }
        lift = false;
    }
}

}  // namespace phyxel
