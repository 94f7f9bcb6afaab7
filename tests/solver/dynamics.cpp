#include "solver/dynamics.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Dense>

#include "support/two_threads.h"

namespace phyxel {
namespace {

/// M^-1/2 K M^-1/2 at rest, symmetrized.
Eigen::MatrixXd scaled_stiffness(const Model& m) {
    const auto n = static_cast<Eigen::Index>(m.rest.size());
    Eigen::MatrixXd K(3 * n, 3 * n);
    ForceWorkspace work;
    std::vector<Vec3> unit(m.rest.size()), column(m.rest.size());
    for (Eigen::Index j = 0; j < 3 * n; ++j) {
        unit[j / 3][j % 3] = std::sqrt(m.inverse_mass[j / 3]);
        stiffness_action(m, m.rest, unit, work, threads, column);
        unit[j / 3] = {};
        for (Eigen::Index i = 0; i < 3 * n; ++i) K(i, j) = column[i / 3][i % 3] * std::sqrt(m.inverse_mass[i / 3]);
    }
    return 0.5 * (K + K.transpose());
}

}  // namespace

std::vector<double> frequencies(const Model& m) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled_stiffness(m), Eigen::EigenvaluesOnly);
    std::vector<double> omega;
    for (double lambda : solver.eigenvalues()) omega.push_back(std::sqrt(std::max(0.0, lambda)));
    return omega;
}

Mode lowest_elastic_mode(const Model& m) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled_stiffness(m));
    constexpr Eigen::Index rigid = 6;
    Mode mode{std::sqrt(solver.eigenvalues()[rigid]), std::vector<Vec3>(m.rest.size())};
    for (std::size_t i = 0; i < m.rest.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            mode.shape[i][c] = solver.eigenvectors()(static_cast<Eigen::Index>(3 * i + c), rigid) *
                               std::sqrt(m.inverse_mass[i] * m.total_mass);
    return mode;
}

double largest_frequency(const Model& m, int steps) {
    const std::size_t n = m.rest.size();
    ForceWorkspace work;
    const auto product = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) sum += m.mass[i] * dot(a[i], b[i]);
        return sum;
    };
    std::vector<std::vector<Vec3>> basis;
    std::vector<Vec3> next = random_field(n, 1, 12), image(n);
    steps = std::min(steps, static_cast<int>(3 * n) - 6);
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(steps, steps);
    for (int k = 0; k < steps; ++k) {
        for (int pass = 0; pass < 2; ++pass)
            for (const auto& b : basis) {
                const double share = product(next, b);
                for (std::size_t i = 0; i < n; ++i) next[i] -= share * b[i];
            }
        const double size = std::sqrt(product(next, next));
        if (k > 0) T(k, k - 1) = T(k - 1, k) = size;
        for (Vec3& v : next) v /= size;
        basis.push_back(next);
        stiffness_action(m, m.rest, next, work, threads, image);
        for (std::size_t i = 0; i < n; ++i) image[i] *= m.inverse_mass[i];
        T(k, k) = product(image, basis.back());
        next = image;
    }
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(T).eigenvalues().maxCoeff());
}

}  // namespace phyxel
