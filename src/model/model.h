#pragma once

#include <vector>

#include "approximation/node_filter.h"
#include "approximation/stencils.h"
#include "material/law.h"

namespace phyxel {

/// Stabilization of one point a node: U = sum_q kappa_q/2 sum_j w_qj |x_qj - F_q X_qj|^2 with x_qj = x_j - x_q, which
/// vanishes for linear fields.
struct NodalStabilization {
    std::vector<double> kappa;        ///< [points] alpha E V_q / sum_j w_qj |X_qj|^2 [N/m]; 0 where no node is
    std::vector<double> weight;       ///< [pairs] w_qj; 0 for the node itself
    std::vector<std::uint16_t> self;  ///< [points] slot of the point's own node in its block
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
    double total_mass = 0;             ///< [kg] density times the clipped volume
    double node_length = 0;            ///< [m] edge of a cube with the volume of one node

    Material settings;
    MaterialPoint material;

    double stabilization = 0;          ///< beta (eight points a cell) or alpha (one point a node)
    NodeFilter filter;                 ///< eight points a cell; empty when not stabilized
    std::vector<double> filter_share;  ///< [nodes] beta m_i / (rho a^2) [m]: stiffness over Young's modulus
    NodalStabilization nodal;          ///< one point a node; empty when not stabilized
};

/// Node positions and velocities: all that changes while a body moves.
struct State {
    std::vector<Vec3> x;  ///< [nodes] [m]
    std::vector<Vec3> v;  ///< [nodes] [m/s]
};

/// Builds the model of a sampled body. `report` says how the stencils turned out.
Model build_model(Sampling sampling, const BodySettings& settings, const Threads& threads, StencilReport& report);

/// Changes the material of a model, same density: stabilization follows the modulus.
void set_material(Model& model, const Material& material);

}  // namespace phyxel
