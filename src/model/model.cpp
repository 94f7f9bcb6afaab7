#include "model/model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace phyxel {
namespace {

constexpr double default_filter_strength =
    0.2;  ///< cleanest low spectrum of a free sphere; costs -0.65 % in coarse bending
constexpr double default_nodal_strength =
    0.15;  ///< 0.5 stiffens coarse bending by 6 to 9 %, below 0.1 false modes appear

/// kappa over Young's modulus, and the pair weights.
NodalStabilization build_nodal(const Model& m) {
    const Stencils& st = m.stencils;
    NodalStabilization nodal;
    nodal.kappa.resize(st.points());
    nodal.weight.resize(st.pairs());
    nodal.self.resize(st.points());
    for (const auto& block : st.blocks)
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
            const std::uint32_t self = m.sampling.point_node[q];
            if (self == no_index) continue;
            double moment = 0;
            const double radius = m.approximation.support * static_cast<double>(st.support[q]);
            for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k) {
                const std::uint32_t node = st.slot_node[block.slot_begin + st.local[k]];
                const double distance = norm(m.rest[node] - m.rest[self]);
                if (node == self) nodal.self[q] = st.local[k];
                nodal.weight[k] = node == self ? 0 : weight(m.approximation.kernel, distance / radius);
                moment += nodal.weight[k] * distance * distance;
            }
            if (moment > 0) nodal.kappa[q] = m.stabilization * m.settings.youngs_modulus * m.volumes[q] / moment;
        }
    return nodal;
}

}  // namespace

Model build_model(Sampling sampling, const BodySettings& settings, const Threads& threads, StencilReport& report) {
    Model m;
    const bool grid = sampling.quadrature == Quadrature::grid;
    m.approximation.kernel = kernel_shape(settings);
    m.approximation.support = support_radius(settings, sampling.spacing);
    m.approximation.nodal_gradients = !grid;
    m.approximation.consistency_correction = settings.consistency_correction && !sampling.boundary.empty();

    StencilBuild build = build_stencils(sampling, m.approximation, threads);
    report = build.report;
    m.stencils = std::move(build.stencils);
    m.volumes = sampling.volumes;
    m.sampling = std::move(sampling);
    for (const Vec3& p : m.sampling.nodes) m.rest.push_back(m.sampling.frame.to_rest(p));

    // Mass: the volumes shared out by Shepard weights. Clipped cells as nodal masses would raise the largest frequency
    // a thousandfold.
    m.settings = settings.material;
    m.material = material_point(settings.material);
    m.largest_modulus = settings.material.youngs_modulus;
    const double density = settings.material.density;
    double smallest =
        build.node_volumes.empty() ? 0 : *std::max_element(build.node_volumes.begin(), build.node_volumes.end());
    smallest *= 1e-9;  // a node that no point sees must still have a mass to divide by
    for (double V : build.node_volumes) m.mass.push_back(density * std::max(V, smallest));
    for (double mass : m.mass) m.inverse_mass.push_back(1 / mass);
    m.total_mass = std::accumulate(m.mass.begin(), m.mass.end(), 0.0);
    m.node_length = m.sampling.spacing / (m.sampling.lattice == Lattice::bcc ? std::cbrt(2.0) : 1);

    const double standard = grid ? default_filter_strength : default_nodal_strength;
    m.stabilization = settings.stabilization < 0 ? standard : settings.stabilization;
    if (m.stabilization > 0) {
        if (grid) {
            m.filter = build_filter(m.sampling, m.approximation, threads);
            for (double mass : m.mass)
                m.filter_stiffness.push_back(m.settings.youngs_modulus * m.stabilization * mass /
                                             (density * m.node_length * m.node_length));
        } else {
            m.nodal = build_nodal(m);
        }
    }
    return m;
}

void set_material(Model& m, const Material& material) {
    const double ratio = material.youngs_modulus / m.settings.youngs_modulus;
    for (double& kappa : m.nodal.kappa) kappa *= ratio;
    for (double& stiffness : m.filter_stiffness) stiffness *= ratio;
    m.largest_modulus = material.youngs_modulus;
    m.settings = material;
    m.material = material_point(material);
}

}  // namespace phyxel
