#pragma once

#include <optional>
#include <vector>

#include "approximation/node_filter.h"
#include "approximation/stencils.h"
#include "material/law.h"
#include "model/mixture.h"

namespace phyxel {

/// Stabilization of one point a node: U = sum_q kappa_q/2 sum_j w_qj |x_qj - F_q X_qj|^2 with x_qj = x_j - x_q, which
/// vanishes for linear fields.
struct NodalStabilization {
    std::vector<double> kappa;        ///< [points] alpha E V_q / sum_j w_qj |X_qj|^2 [N/m]; 0 where no node is
    std::vector<double> weight;       ///< [pairs] w_qj; 0 for the node itself
    std::vector<std::uint16_t> self;  ///< [points] slot of the point's own node in its block
};

/// Groups of points that share one dilatation, its mean over their volume, so that nearly incompressible material does
/// not lock: sum_c lambda_c/2 V_c theta_c^2 stands in for the points' sum_q V_q lambda_q/2 theta_q^2.
struct DilatationCells {
    std::vector<std::uint32_t> cell;             ///< [points] or `no_index`: the point's own dilatation counts
    std::vector<std::uint32_t> offset;           ///< [cells + 1] into `points`
    std::vector<std::uint32_t> points;           ///< of each cell, ascending
    std::vector<double> volume;                  ///< [cells] V_c [m^3]
    std::vector<double> lambda;                  ///< [cells] volume mean of the points' [Pa]
    bool empty() const { return cell.empty(); }  ///< every point by itself
};

/// A soft body as it was made: constant while it moves.
struct Model {
    Sampling sampling;  ///< geometry, in the lattice frame
    ApproximationSettings approximation;
    Stencils stencils;
    std::vector<double> volumes;  ///< [points] V_q [m^3]

    std::vector<Vec3> rest;            ///< [nodes] X [m], rest space
    std::vector<double> mass;          ///< [nodes] [kg], > 0
    std::vector<double> inverse_mass;  ///< [nodes] [1/kg]
    std::vector<double> node_volumes;  ///< [nodes] Shepard sum of V_q [m^3], > 0
    double total_mass = 0;             ///< [kg] density times the clipped volume
    double node_length = 0;            ///< [m] edge of a cube with the volume of one node

    Material settings;                           ///< the body's own, where no region says otherwise
    MaterialPoint material;                      ///< likewise
    Mixture mixture;                             ///< empty: `material` everywhere
    std::vector<MaterialPoint> point_materials;  ///< [points] of a mixture; empty: `material` everywhere
    double largest_modulus = 0;                  ///< Young's, of all materials [Pa]
    std::optional<bool> mean_dilatation;         ///< as `BodySettings::mean_dilatation`
    DilatationCells dilatation;                  ///< empty unless nearly incompressible

    bool uniform() const { return point_materials.empty(); }
    const MaterialPoint& point_material(std::size_t q) const { return uniform() ? material : point_materials[q]; }

    double stabilization = 0;              ///< beta (eight points a cell) or alpha (one point a node)
    NodeFilter filter;                     ///< eight points a cell; empty when not stabilized
    std::vector<double> filter_stiffness;  ///< [nodes] beta / a^2 times the Shepard sum of E V_q [N/m]
    NodalStabilization nodal;              ///< one point a node; empty when not stabilized
};

/// Node positions and velocities: all that changes while a body moves.
struct State {
    std::vector<Vec3> x;  ///< [nodes] [m]
    std::vector<Vec3> v;  ///< [nodes] [m/s]
};

/// Builds the model of a sampled body. `report` says how the stencils turned out.
Model build_model(Sampling sampling, const BodySettings& settings, const Threads& threads, StencilReport& report);

/// Young's modulus at point q [Pa].
inline double youngs_modulus(const Model& m, std::size_t q) {
    return m.mixture.empty() ? m.settings.youngs_modulus : m.mixture.mean(q, &Material::youngs_modulus);
}

/// Changes the material of a model, same density: stabilization follows the modulus. `which`: 0 the body's own, then
/// those of its regions.
void set_material(Model& model, const Material& material, std::size_t which = 0);

}  // namespace phyxel
