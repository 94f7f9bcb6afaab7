#pragma once

#include <cstddef>
#include <vector>

#include "phyxel/vector.h"

/// Element-free Galerkin elasticity as in listing 4.1.1 of
///     C. Stegmayr, "Procedural deformation and destruction in real-time", Master thesis, 2008,
/// once more, slowly, one line of the listing at a time, with its misprints corrected: the oracle that the fast code is
/// tested against. Nothing here is stored between steps that the listing does not store; neighbours, weights and moment
/// matrices are found anew for every force. A node is what the thesis calls a phyxel; it carries the motion, and it is
/// the one place where the stress of its volume is evaluated.

namespace phyxel::reference {

/// What is constant. All arrays have one entry a node.
struct Body {
    std::vector<Vec3> X;          ///< rest positions [m]
    std::vector<double> mass;     ///< [kg]; they sum to the mass of the body
    std::vector<double> volume;   ///< [m^3]; geometric: they sum to the volume of the body
    double support = 0;           ///< h [m], the same for all; at least four nodes off one plane within it
    double lambda = 0, mu = 0;    ///< Lamé's moduli [Pa]
    double volume_stiffness = 0;  ///< k_v [Pa] of the volume-conserving force, 3.60
    Vec3 gravity{};               ///< [m/s^2]
};

/// What moves. One entry a node.
struct State {
    std::vector<Vec3> u;  ///< displacements [m] at time t
    std::vector<Vec3> v;  ///< velocities [m/s] at time t - dt/2
};

/// Which misprints to leave in, so that a test can show what each does. All false: the corrected method.
struct Misprints {
    bool strain_without_half = false;     ///< 3.34: strain J^T J - I in place of half of it
    bool twofold_force = false;           ///< 3.42 and line 2(a)v: the factor 2
    bool stress_before_gradient = false;  ///< 3.42: sigma J d in place of J sigma d ("J is symmetric")
    bool volume_force = false;            ///< line 2(a)vi: sign turned and factor V missing
    bool position_over_mass = false;      ///< line 2(b)ii: displacement divided by the mass once more
};

/// Poly-6 weight, 3.15 [1/m^3].
double poly6(double distance, double support);

/// Moment matrix A_i = sum_j x_ij x_ij^T w_ij, 3.31, line 1(b)iii.
Mat3 moment_matrix(const Body& body, std::size_t i);

/// J_i = grad u_i + I, 3.33 and 3.34, lines 2(a)i and 2(a)ii: the deformation gradient at node i.
Mat3 jacobian(const Body& body, const std::vector<Vec3>& u, std::size_t i);

/// Strain energy with the volume term of 3.60 [J]; the corrected forces are its negative gradient.
double elastic_energy(const Body& body, const std::vector<Vec3>& u);

/// Internal forces [N], lines 2(a)i to 2(a)vii.
std::vector<Vec3> internal_forces(const Body& body, const std::vector<Vec3>& u, const Misprints& misprints = {});

/// The state at time 0 for 3.53: the velocities `v` given at time 0 go half a step back.
State start(const Body& body, std::vector<Vec3> u, std::vector<Vec3> v, double dt);

/// One leap-frog step, line 2(b), 3.53.
void leap_frog_step(const Body& body, State& state, double dt, const Misprints& misprints = {});

/// Kinetic, elastic and gravitational energy at time t [J], the velocities carried forward half a step.
double total_energy(const Body& body, const State& state, double dt);

/// As printed in line 1(b)iv: m = 3 pi rho h^3 / 4, whatever the volume of the body.
double printed_mass(double density, double support);

/// As printed in lines 1(c)ii and 1(c)iii: V_i = m_i / sum_j m_j w_ij, from the kernel density.
std::vector<double> printed_volumes(const Body& body);

/// As printed in line 1(b)ii: h_i = mean distance of the k = 9 nearest other nodes.
std::vector<double> printed_supports(const std::vector<Vec3>& X);

}  // namespace phyxel::reference
