#pragma once

#include <span>
#include <vector>

#include "base/simd.h"
#include "model/model.h"
#include "phyxel/solver.h"

namespace phyxel {

/// Work arrays of the force evaluation of one body, kept between steps.
struct ForceWorkspace {
    std::vector<Double4> slot_x, slot_v, slot_f;        ///< [slots] what a block gathers and scatters
    std::vector<double> block_power;                    ///< [blocks] viscous power
    std::vector<double> dilatation, dilatation_rate;    ///< [points] of those that share it with their cell
    std::vector<double> pressure, pressure_rate;        ///< [cells] lambda times their means [Pa], [Pa/s]
    std::vector<Vec3> moved, filtered, twice_filtered;  ///< [nodes] x, (I - Phi) x and (I - Phi)^2 x
};

/// [points] F_q at node positions x.
std::vector<Mat3> deformation_gradients(const Model& model, std::span<const Vec3> x, const Threads& threads);

/// Strain energy sum_q V_q Psi(F_q) [J], with shared dilatation where the material is nearly incompressible
/// (forces/mean_dilatation.h).
double elastic_energy(const Model& model, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads);

/// Energy of the stabilization [J]; zero for linear fields.
double stabilization_energy(const Model& model, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads);

/// Writes f = -d(elastic + stabilization energy)/dx [N], f_i = -sum_q V_q P_q g_qi, into `f`; with `stiffness_damping`
/// beta > 0 [s] also the viscous forces of the stress P_v = F S_v, S_v = beta (lambda tr(dE/dt) I + 2 mu dE/dt),
/// dE/dt = sym(F^T dF/dt): Rayleigh's beta K at rest, and objective and never driving in any other state; the
/// stabilization is damped by beta times its constant Hessian. Returns the power [W] that the viscous forces take out
/// of the motion, never negative.
double internal_forces(const Model& model, std::span<const Vec3> x, std::span<const Vec3> v, double stiffness_damping,
                       ForceWorkspace& work, const Threads& threads, std::span<Vec3> f);

/// Writes K(x) d, the derivative of the internal forces' negative in the direction d, elastic and stabilization, into
/// `out`.
void stiffness_action(const Model& model, std::span<const Vec3> x, std::span<const Vec3> d, ForceWorkspace& work,
                      const Threads& threads, std::span<Vec3> out, Tangent tangent = Tangent::exact);

}  // namespace phyxel
