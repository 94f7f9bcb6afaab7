#include "reference/fem/newton.h"

#include <algorithm>
#include <cmath>

#include "material/lame.h"

namespace phyxel::fem {
namespace {

using Vector = Eigen::VectorXd;

/// Residual forces on the free coordinates, and the size of the forces that balance there.
struct Balance {
    Vector residual;
    double scale = 0;

    double relative() const { return residual.norm() / scale; }
};

double squared_size(const std::vector<Vec3>& f) {
    double sum = 0;
    for (const Vec3& force : f) sum += norm_squared(force);
    return sum;
}

/// What rounding leaves of forces that balance: those of a strain of 1e-14 across the body.
double rounding_force(const Solid& solid) {
    double V = 0;
    for (const double volume : solid.V) V += volume;
    return 1e-14 * p_wave_modulus(solid.material.lame) * std::cbrt(V * V);
}

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    std::vector<Vec3> d(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
    return d;
}

/// M (x - y) over the free coordinates; the fixed ones have no part in it.
Vector inertial_pull(const System& system, const Inertia& inertia, const std::vector<Vec3>& x) {
    if (inertia.c == 0) return Vector::Zero(system.size());
    const Vector offset = system.gather(difference(x, inertia.y));
    const Vector momentum = system.mass().selfadjointView<Eigen::Lower>() * offset;
    return inertia.c * momentum;
}

Balance balance(const System& system, const Inertia& inertia, const std::vector<Vec3>& x) {
    const std::vector<Vec3> elastic = elastic_forces(system.solid, x);
    const Vector dead = system.gather(system.conditions.force), pull = inertial_pull(system, inertia, x);
    const Vector internal = system.gather(elastic);
    // Support reactions count: a body stretched by its grips alone has no other load.
    const double reactions = std::sqrt(std::max(0.0, squared_size(elastic) - internal.squaredNorm()));
    return {dead + internal - pull, dead.norm() + pull.norm() + reactions};
}

double potential(const System& system, const Inertia& inertia, const std::vector<Vec3>& x) {
    const std::vector<Vec3>& f = system.conditions.force;
    double value = elastic_energy(system.solid, x);
    for (std::size_t i = 0; i < f.size(); ++i) value -= dot(f[i], x[i]);
    if (inertia.c == 0) return value;
    return value + 0.5 * inertial_pull(system, inertia, x).dot(system.gather(difference(x, inertia.y)));
}

bool is_definite(const Solver& solver) { return solver.info() == Eigen::Success && solver.vectorD().minCoeff() > 0; }

SparseMatrix tangent(const System& system, const Inertia& inertia, const std::vector<Vec3>& x) {
    SparseMatrix A = system.stiffness(x);
    if (inertia.c != 0) A += inertia.c * system.mass();
    return A;
}

/// Factorizes A plus the smallest of the tried multiples of the identity that makes it definite. They begin far below
/// the mean of the diagonal: the mode in which a slender body buckles is a million times softer than that, and a large
/// shift would hold it.
void factorize_definite(Solver& solver, SparseMatrix A) {
    const double mean = A.diagonal().cwiseAbs().mean();
    for (double shift = 1e-8 * mean; !is_definite(solver) && shift < 1e3 * mean; shift *= 10) {
        for (Eigen::Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += shift;
        solver.factorize(A);
    }
}

/// Tells a sequence of full steps that leads nowhere. Bodies that bend pass through residuals of a hundred thousand
/// times the load after the first, linear step, and converge all the same.
struct Divergence {
    double first = -1, last = 0;
    int risen = 0;

    bool seen(double residual) {
        if (first < 0) first = last = residual;
        risen = residual > last ? risen + 1 : 0;
        last = residual;
        return !(residual < 1e7 * first) || risen == 3;
    }
};

/// Goes along `step`, halved until the potential decreases enough (Armijo's rule), but for its rounding.
void go_downhill(const System& system, const Inertia& inertia, const Vector& residual, const Vector& step,
                 std::vector<Vec3>& x) {
    const std::vector<Vec3> start = x;
    const double before = potential(system, inertia, x), slope = residual.dot(step);
    for (double part = 1; part > 1e-4; part /= 2) {
        x = start;
        system.add(part * step, x);
        if (potential(system, inertia, x) <= before - 1e-4 * part * slope + 1e-13 * std::abs(before)) return;
    }
}

/// Iterates until balanced, hopeless, or after so many linear solves.
NewtonReport iterate(System& system, const Inertia& inertia, std::vector<Vec3>& x, double tolerance, int max_iterations,
                     bool searched) {
    NewtonReport report;
    const double rounding = rounding_force(system.solid);
    Divergence divergence;
    while (true) {
        // Give up?
        const Balance forces = balance(system, inertia, x);
        const double size = forces.residual.norm();
        const bool small = size <= tolerance * forces.scale + rounding;
        report.residual = size / (forces.scale + rounding);
        const bool diverges = searched ? !std::isfinite(size) : divergence.seen(size);
        if (!small && (diverges || report.iterations == max_iterations)) return report;

        // Done? The tangent tells a minimum from a saddle.
        const SparseMatrix A = tangent(system, inertia, x);
        system.solver().factorize(A);
        if (small) report.converged = is_definite(system.solver());
        if (small) return report;

        // Step.
        if (searched && !is_definite(system.solver())) factorize_definite(system.solver(), A);
        if (system.solver().info() != Eigen::Success) return report;
        const Vector step = system.solver().solve(forces.residual);
        if (searched) go_downhill(system, inertia, forces.residual, step, x);
        else system.add(step, x);
        ++report.iterations;
    }
}

}  // namespace

NewtonReport minimize(System& system, const Inertia& inertia, std::vector<Vec3>& x, const NewtonSettings& settings) {
    int left = settings.max_iterations;
    bool searched = false;
    while (true) {
        // Full steps, to the end.
        std::vector<Vec3> tried = x;
        NewtonReport report = iterate(system, inertia, tried, settings.tolerance, left, false);
        left -= report.iterations;

        // If they fail, ten searched ones from where these began, closer to the solution or all the way.
        if (!report.converged && left > 0) {
            report = iterate(system, inertia, x, settings.tolerance, std::min(left, 10), true);
            left -= report.iterations;
            searched = true;
            if (!report.converged && left > 0 && report.iterations > 0) continue;
            tried = x;
        }
        x = tried;
        report.iterations = settings.max_iterations - left;
        report.searched = searched;
        return report;
    }
}

}  // namespace phyxel::fem
