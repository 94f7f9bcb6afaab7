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

bool is_definite(const Eigen::SimplicialLDLT<SparseMatrix>& solver) {
    return solver.info() == Eigen::Success && solver.vectorD().minCoeff() > 0;
}

SparseMatrix tangent(const System& system, const Inertia& inertia, const std::vector<Vec3>& x) {
    SparseMatrix A = system.stiffness(x);
    if (inertia.c != 0) A += inertia.c * system.mass();
    return A;
}

/// Factorizes A plus the smallest tried multiple of the identity that makes it definite.
void factorize_definite(Eigen::SimplicialLDLT<SparseMatrix>& solver, SparseMatrix A) {
    const double mean = A.diagonal().cwiseAbs().mean();
    solver.factorize(A);
    for (double shift = 1e-3 * mean; !is_definite(solver) && shift < 1e3 * mean; shift *= 4) {
        for (Eigen::Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += shift;
        solver.factorize(A);
    }
}

/// Full steps: quadratic near the solution, and no other guard than to notice divergence.
NewtonReport full_steps(System& system, const Inertia& inertia, std::vector<Vec3>& x, const NewtonSettings& settings) {
    NewtonReport report;
    double first = 0, last = 0;
    int risen = 0;
    const double rounding = rounding_force(system.solid);
    while (true) {
        const Balance forces = balance(system, inertia, x);
        const double size = forces.residual.norm();
        report.residual = size / (forces.scale + rounding);

        // Converged, hopeless, or on.
        const bool small = size <= settings.tolerance * forces.scale + rounding;
        if (report.iterations == 0) first = size;
        risen = report.iterations > 0 && size > last ? risen + 1 : 0;
        last = size;
        if (!small &&
            (!std::isfinite(size) || size > 1e6 * first || risen == 3 || report.iterations == settings.max_iterations))
            return report;
        system.solver().factorize(tangent(system, inertia, x));
        if (small) {
            report.converged = is_definite(system.solver());
            return report;
        }
        if (system.solver().info() != Eigen::Success) return report;
        system.add(system.solver().solve(forces.residual), x);
        ++report.iterations;
    }
}

/// Steps along definite tangents, each shortened until the potential decreases (Armijo).
NewtonReport searched_steps(System& system, const Inertia& inertia, std::vector<Vec3>& x,
                            const NewtonSettings& settings) {
    NewtonReport report{.searched = true};
    const double rounding = rounding_force(system.solid);
    while (true) {
        const Balance forces = balance(system, inertia, x);
        const double size = forces.residual.norm();
        report.residual = size / (forces.scale + rounding);
        const bool small = size <= settings.tolerance * forces.scale + rounding;
        if (!small && report.iterations == settings.max_iterations) return report;
        const SparseMatrix A = tangent(system, inertia, x);
        if (small) {
            system.solver().factorize(A);
            report.converged = is_definite(system.solver());
            return report;
        }
        factorize_definite(system.solver(), A);
        const Vector step = system.solver().solve(forces.residual);
        ++report.iterations;

        // Halve until the potential has decreased, up to its rounding.
        const double before = potential(system, inertia, x), slope = forces.residual.dot(step);
        const std::vector<Vec3> start = x;
        for (double part = 1; part > 1e-4; part /= 2) {
            x = start;
            system.add(part * step, x);
            if (potential(system, inertia, x) <= before - 1e-4 * part * slope + 1e-13 * std::abs(before)) break;
        }
    }
}

}  // namespace

NewtonReport minimize(System& system, const Inertia& inertia, std::vector<Vec3>& x, const NewtonSettings& settings) {
    const std::vector<Vec3> start = x;
    const NewtonReport full = full_steps(system, inertia, x, settings);
    if (full.converged) return full;
    x = start;
    NewtonReport searched = searched_steps(system, inertia, x, settings);
    searched.iterations += full.iterations;
    return searched;
}

}  // namespace phyxel::fem
