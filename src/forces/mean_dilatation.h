#pragma once

#include <span>
#include <vector>

#include "model/model.h"

namespace phyxel {

/// Nearly incompressible points take part in sum_c lambda_c/2 V_c theta_c^2, with theta_c = sum_q V_q theta(F_q)/V_c
/// the mean dilatation of their cell, and keep the rest of their law to themselves: P_q = P(F_q; lambda = 0) + p_c
/// dtheta/dF_q with the common p_c = lambda_c theta_c. One constraint a cell, where eight would leave the nodes nothing
/// to move with. Test: tests/forces/mean_dilatation_test.cpp.

/// Whether point q shares its dilatation.
inline bool shares_dilatation(const Model& m, std::size_t q) {
    return !m.dilatation.empty() && m.dilatation.cell[q] != no_index;
}

/// Writes lambda_c times the cells' means of `value` [points] into `out` [cells].
void cell_means_times_lambda(const Model& model, std::span<const double> value, const Threads& threads,
                             std::vector<double>& out);

/// Energy of the shared dilatations, sum_c V_c p_c^2/(2 lambda_c) [J].
double shared_dilatation_energy(const Model& model, std::span<const double> pressure);

/// P of point q; `pressure` p_c [cells] [Pa].
inline Mat3 point_stress(const Model& m, std::size_t q, const Mat3& F, std::span<const double> pressure) {
    const MaterialPoint& material = m.point_material(q);
    if (!shares_dilatation(m, q)) return stress(material, F);
    return stress(without_dilatation(material), F) +
           pressure[m.dilatation.cell[q]] * dilatation_gradient(material.law, F);
}

/// Change of P with F by dF and p_c by its change [cells].
inline Mat3 point_stress_action(const Model& m, std::size_t q, const Mat3& F, const Mat3& dF,
                                std::span<const double> pressure, std::span<const double> pressure_change) {
    const MaterialPoint& material = m.point_material(q);
    if (!shares_dilatation(m, q)) return stress_action(material, F, dF);
    const std::uint32_t c = m.dilatation.cell[q];
    return stress_action(without_dilatation(material), F, dF) +
           pressure_change[c] * dilatation_gradient(material.law, F) +
           pressure[c] * dilatation_gradient_action(material.law, F, dF);
}

/// Energy density of point q without what its cell holds.
inline double own_energy(const Model& m, std::size_t q, const Mat3& F) {
    const MaterialPoint& material = m.point_material(q);
    return energy(shares_dilatation(m, q) ? without_dilatation(material) : material, F);
}

/// [points] First Piola-Kirchhoff stress and energy density at deformation gradients F, the cells' share included.
struct PointStresses {
    std::vector<Mat3> stress;            ///< [Pa]
    std::vector<double> energy_density;  ///< [J/m^3]
};
PointStresses point_stresses(const Model& model, std::span<const Mat3> F, const Threads& threads);

}  // namespace phyxel
