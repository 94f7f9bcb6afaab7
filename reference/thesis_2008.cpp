#include "reference/thesis_2008.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace phyxel::reference {
namespace {

/// Line 1(c)i: all nodes within the support, node i itself included (its x_ij is zero and adds nothing but weight).
std::vector<std::size_t> neighbors(const Body& body, std::size_t i) {
    std::vector<std::size_t> found;
    for (std::size_t j = 0; j < body.X.size(); ++j)
        if (norm(body.X[j] - body.X[i]) < body.support) found.push_back(j);
    return found;
}

Vec3 x_ij(const Body& body, std::size_t i, std::size_t j) { return body.X[j] - body.X[i]; }

double w_ij(const Body& body, std::size_t i, std::size_t j) { return poly6(norm(x_ij(body, i, j)), body.support); }

Mat3 inverse_moment_matrix(const Body& body, std::size_t i) {
    const Mat3 A = moment_matrix(body, i);
    assert(determinant(A) > 0 && "a node needs four neighbours that are not in one plane");
    return inverse(A);
}

/// Line 2(a)iii. Equation 3.34 prints the strain without the half, the listing with it. The half belongs there: with
/// it, and no factor two in the force, the energy 3.7 is Hooke's with the given Young's modulus and Poisson's ratio.
Mat3 strain(const Mat3& J, const Misprints& misprints) {
    return (misprints.strain_without_half ? 1.0 : 0.5) * (transpose(J) * J - Mat3::identity());
}

/// Line 2(a)iv. The matrix C of 3.14 is for tensor shear strains; lambda and mu say the same without six-vectors.
Mat3 stress(const Body& body, const Mat3& epsilon) {
    return body.lambda * trace(epsilon) * Mat3::identity() + 2 * body.mu * epsilon;
}

/// The rows J_v x J_w, J_w x J_u, J_u x J_v of 3.62.
Mat3 row_products(const Mat3& J) {
    return {{cross(J.rows[1], J.rows[2]), cross(J.rows[2], J.rows[0]), cross(J.rows[0], J.rows[1])}};
}

/// Line 2(a)v: F^(i) = -V J sigma A^-1.
///
/// Printed with a factor 2, which is right only with the strain of 3.34 and half of Hooke's moduli: the energy
/// V/2 eps:C:eps has the derivative V sigma : d eps, and d eps = sym(J^T dJ), so that the force is exactly half of
/// what is printed. 3.42 has sigma J in place of J sigma "because J is symmetric", which it is in no rotated body:
/// 3.41 drops a transpose, d(J^T J) = dJ^T J + J^T dJ contracted with the symmetric sigma is 2 (J sigma) : dJ.
Mat3 elastic_force_matrix(const Mat3& J, const Mat3& sigma, double volume, const Mat3& inverse_A,
                          const Misprints& misprints) {
    const double factor = misprints.twofold_force ? 2 : 1;
    const Mat3 product = misprints.stress_before_gradient ? sigma * J : J * sigma;
    return -factor * volume * (product * inverse_A);
}

/// Line 2(a)vi: F^(v) = -V k_v (|J| - 1) cof(J) A^-1.
///
/// Printed without V, though 3.60 is an energy per volume as the strain energy is, and in the listing with the sign of
/// 3.62, which is the force on node i: the listing adds it to node j, and pushes a squeezed body further in.
Mat3 volume_force_matrix(const Body& body, const Mat3& J, double volume, const Mat3& inverse_A,
                         const Misprints& misprints) {
    const Mat3 printed = body.volume_stiffness * (determinant(J) - 1) * (row_products(J) * inverse_A);
    return misprints.volume_force ? printed : -volume * printed;
}

/// Lines 2(b)ii and iv: internal force plus gravity on node i [N].
Vec3 total_force(const Body& body, const std::vector<Vec3>& internal, std::size_t i) {
    return internal[i] + body.mass[i] * body.gravity;
}

}  // namespace

double poly6(double distance, double support) {
    if (distance >= support) return 0;
    const double q = support * support - distance * distance;
    return 315 / (64 * std::numbers::pi * std::pow(support, 9)) * q * q * q;
}

Mat3 moment_matrix(const Body& body, std::size_t i) {
    Mat3 A;
    for (const std::size_t j : neighbors(body, i)) A += w_ij(body, i, j) * outer(x_ij(body, i, j), x_ij(body, i, j));
    return A;
}

Mat3 jacobian(const Body& body, const std::vector<Vec3>& u, std::size_t i) {
    // Line 2(a)i; row by row (A^-1 sum (u_j - u_i) x_ij w_ij)^T, as in 3.33.
    Mat3 sum;
    for (const std::size_t j : neighbors(body, i)) sum += w_ij(body, i, j) * outer(u[j] - u[i], x_ij(body, i, j));
    const Mat3 gradient = sum * transpose(inverse_moment_matrix(body, i));

    // Line 2(a)ii.
    return gradient + Mat3::identity();
}

double elastic_energy(const Body& body, const std::vector<Vec3>& u) {
    double energy = 0;
    for (std::size_t i = 0; i < body.X.size(); ++i) {
        const Mat3 J = jacobian(body, u, i);
        const Mat3 epsilon = strain(J, {});
        const double growth = determinant(J) - 1;
        energy += body.volume[i] * 0.5 * contract(epsilon, stress(body, epsilon));
        energy += body.volume[i] * 0.5 * body.volume_stiffness * growth * growth;
    }
    return energy;
}

std::vector<Vec3> internal_forces(const Body& body, const std::vector<Vec3>& u, const Misprints& misprints) {
    std::vector<Vec3> f(body.X.size());
    for (std::size_t i = 0; i < body.X.size(); ++i) {
        // Lines 2(a)i to 2(a)vi.
        const Mat3 inverse_A = inverse_moment_matrix(body, i);
        const Mat3 J = jacobian(body, u, i);
        const Mat3 sigma = stress(body, strain(J, misprints));
        const Mat3 F = elastic_force_matrix(J, sigma, body.volume[i], inverse_A, misprints) +
                       volume_force_matrix(body, J, body.volume[i], inverse_A, misprints);

        // Line 2(a)vii. Both steps A and B print f_i; A is the force on the neighbour j, B its reaction on i. The pair
        // alone (3.37 to 3.43) would forget that u_i also changes the energies of the nodes around: the loop over all
        // i gathers them.
        for (const std::size_t j : neighbors(body, i)) {
            const Vec3 force = F * (w_ij(body, i, j) * x_ij(body, i, j));
            f[j] += force;
            f[i] -= force;
        }
    }
    return f;
}

State start(const Body& body, std::vector<Vec3> u, std::vector<Vec3> v, double dt) {
    const std::vector<Vec3> f = internal_forces(body, u);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] -= dt / (2 * body.mass[i]) * total_force(body, f, i);
    return {std::move(u), std::move(v)};
}

void leap_frog_step(const Body& body, State& state, double dt, const Misprints& misprints) {
    const std::vector<Vec3> f = internal_forces(body, state.u, misprints);
    for (std::size_t i = 0; i < state.u.size(); ++i) {
        // Line 2(b)ii. The displacement prints "/ m" once more and starts from the one before last, against 3.52.
        state.v[i] += dt / body.mass[i] * total_force(body, f, i);
        state.u[i] += dt * state.v[i] / (misprints.position_over_mass ? body.mass[i] : 1.0);
    }
}

double total_energy(const Body& body, const State& state, double dt) {
    // 3.54 carries the velocity on by half a step. Printed with f(t); the force at the time arrived at is right.
    const std::vector<Vec3> f = internal_forces(body, state.u);
    double energy = elastic_energy(body, state.u);
    for (std::size_t i = 0; i < state.u.size(); ++i) {
        const Vec3 v = state.v[i] + dt / (2 * body.mass[i]) * total_force(body, f, i);
        energy += 0.5 * body.mass[i] * norm_squared(v) - body.mass[i] * dot(body.gravity, body.X[i] + state.u[i]);
    }
    return energy;
}

double printed_mass(double density, double support) {
    return 3 * std::numbers::pi * density * support * support * support / 4;
}

std::vector<double> printed_volumes(const Body& body) {
    std::vector<double> volumes;
    for (std::size_t i = 0; i < body.X.size(); ++i) {
        double density = 0;
        for (const std::size_t j : neighbors(body, i)) density += body.mass[j] * w_ij(body, i, j);
        volumes.push_back(body.mass[i] / density);
    }
    return volumes;
}

std::vector<double> printed_supports(const std::vector<Vec3>& X) {
    const std::size_t nearest = 9;
    std::vector<double> supports;
    for (const Vec3& center : X) {
        std::vector<double> distances;
        for (const Vec3& other : X) distances.push_back(norm(other - center));
        std::sort(distances.begin(), distances.end());
        double sum = 0;
        for (std::size_t k = 1; k <= nearest; ++k) sum += distances[k];
        supports.push_back(sum / nearest);
    }
    return supports;
}

}  // namespace phyxel::reference
