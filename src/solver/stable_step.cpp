#include "solver/stable_step.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

/// What twenty or more iterations miss of the largest frequency at most, measured on whole and clipped bodies.
constexpr double margin = 1.05;

/// Lanczos steps for a new body: within 0.2 % of the largest frequency on whole and clipped bodies, all quadratures;
/// sixty power iterations miss 0.5 %.
constexpr int rest_iterations = 16;

/// Start vector without structure, the same for every run.
Vec3 scrambled(std::size_t i) {
    const auto component = [&](std::uint64_t salt) {
        std::uint64_t z =
            (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15u + salt * 0xbf58476d1ce4e5b9u;  // splitmix64
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
    };
    return {component(1), component(2), component(3)};
}

}  // namespace

double LargestFrequency::estimate(const Model& m, std::span<const Vec3> x, int iterations, ForceWorkspace& work,
                                  const Threads& threads) {
    constexpr std::size_t chunk = 1024;
    const std::size_t n = m.rest.size();
    if (mode_.size() != n) {
        mode_.resize(n);
        for (std::size_t i = 0; i < n; ++i) mode_[i] = scrambled(i);
    }
    image_.resize(n);
    double lambda = 0;
    for (int k = 0; k < iterations; ++k) {
        const double size =
            std::sqrt(threads.sum(n, chunk, [&](std::size_t i) { return m.mass[i] * norm_squared(mode_[i]); }));
        if (!(size > 0) || !std::isfinite(size)) return size;  // no stiffness at all, or no longer numbers
        threads.for_each(n, chunk, [&](std::size_t i) { mode_[i] /= size; });
        stiffness_action(m, x, mode_, work, threads, image_);
        // |M^-1 K d| in the metric of the masses: closer than the Rayleigh quotient, and right where K is indefinite.
        lambda = std::sqrt(
            threads.sum(n, chunk, [&](std::size_t i) { return m.inverse_mass[i] * norm_squared(image_[i]); }));
        threads.for_each(n, chunk, [&](std::size_t i) { mode_[i] = m.inverse_mass[i] * image_[i]; });
    }
    return margin * std::sqrt(lambda);
}

double LargestFrequency::estimate_at_rest(const Model& m, ForceWorkspace& work, const Threads& threads) {
    constexpr std::size_t chunk = 1024;
    const std::size_t n = m.rest.size();
    // Vectors orthonormal in the metric of the masses, M^-1 K q_j = beta_{j-1} q_{j-1} + alpha_j q_j + beta_j q_{j+1}
    // (Golub and van Loan, Matrix Computations, section 10.1). Lost orthogonality repeats values and does not harm the
    // largest.
    std::vector<std::vector<Vec3>> q;
    std::vector<double> alpha, beta;
    std::vector<Vec3> next(n);
    for (std::size_t i = 0; i < n; ++i) next[i] = scrambled(i);
    image_.resize(n);
    for (int j = 0; j < rest_iterations; ++j) {
        const double size =
            std::sqrt(threads.sum(n, chunk, [&](std::size_t i) { return m.mass[i] * norm_squared(next[i]); }));
        if (!std::isfinite(size)) return size;
        if (!(size > 0) || (j > 0 && size < 1e-12 * alpha[0])) break;  // all that there is was found
        if (j > 0) beta.push_back(size);
        threads.for_each(n, chunk, [&](std::size_t i) { next[i] /= size; });
        q.push_back(next);
        stiffness_action(m, m.rest, q.back(), work, threads, image_);
        alpha.push_back(threads.sum(n, chunk, [&](std::size_t i) { return dot(q.back()[i], image_[i]); }));
        threads.for_each(n, chunk, [&](std::size_t i) {
            next[i] = m.inverse_mass[i] * image_[i] - alpha[j] * q[j][i];
            if (j > 0) next[i] -= beta[j - 1] * q[j - 1][i];
        });
    }
    mode_.assign(n, {});
    if (alpha.empty()) return 0;

    // The largest value of the tridiagonal matrix, and its vector.
    const Eigen::Map<const Eigen::VectorXd> diagonal(alpha.data(), static_cast<Eigen::Index>(alpha.size()));
    const Eigen::Map<const Eigen::VectorXd> beside(beta.data(), static_cast<Eigen::Index>(alpha.size() - 1));
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> tridiagonal;
    tridiagonal.computeFromTridiagonal(diagonal, beside);
    const Eigen::Index last = diagonal.size() - 1;
    for (std::size_t j = 0; j < q.size(); ++j) {
        const double share = tridiagonal.eigenvectors()(static_cast<Eigen::Index>(j), last);
        threads.for_each(n, chunk, [&](std::size_t i) { mode_[i] += share * q[j][i]; });
    }
    return margin * std::sqrt(std::max(0.0, tridiagonal.eigenvalues()[last]));
}

double stable_step(double omega, double stiffness_damping) {
    constexpr double share = 0.6;
    const double xi = 0.5 * stiffness_damping * omega;
    return share * (2 / omega) * (std::sqrt(1 + xi * xi) - xi);
}

}  // namespace phyxel
