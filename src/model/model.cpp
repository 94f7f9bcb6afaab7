#include "model/model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "approximation/shepard_sums.h"
#include "model/dilatation_cells.h"

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
            if (moment > 0) nodal.kappa[q] = m.stabilization * youngs_modulus(m, q) * m.volumes[q] / moment;
        }
    return nodal;
}

/// [nodes] Shepard sum of a number of the material times V_q; `node_volumes` is that of V_q itself.
std::vector<double> shared_out(const Model& m, double Material::*number, std::span<const double> node_volumes,
                               const Threads& threads) {
    std::vector<double> sums(node_volumes.begin(), node_volumes.end());
    if (m.mixture.empty()) {
        for (double& sum : sums) sum *= m.settings.*number;
        return sums;
    }
    std::vector<double> value(m.volumes.size());
    for (std::size_t q = 0; q < value.size(); ++q) value[q] = m.volumes[q] * m.mixture.mean(q, number);
    sums = shepard_sums(m.sampling, m.approximation, m.stencils, value, threads);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (!(sums[i] > 0)) sums[i] = node_volumes[i] * (m.settings.*number);  // a node that no point sees
    return sums;
}

/// What follows from the materials: laws and moduli of the points, and who shares a dilatation.
void spread_materials(Model& m) {
    m.material = material_point(m.settings);
    m.largest_modulus = m.settings.youngs_modulus;
    if (!m.mixture.empty()) {
        m.mixture.materials[0] = m.settings;
        m.point_materials.resize(m.volumes.size());
        for (std::size_t q = 0; q < m.volumes.size(); ++q) m.point_materials[q] = m.mixture.point(q);
        for (const Material& material : m.mixture.materials)
            m.largest_modulus = std::max(m.largest_modulus, material.youngs_modulus);
    }
    m.dilatation = group_points(m, m.mean_dilatation);
}

void find_filter_stiffness(Model& m, const Threads& threads) {
    const double factor = m.stabilization / (m.node_length * m.node_length);
    m.filter_stiffness = shared_out(m, &Material::youngs_modulus, m.node_volumes, threads);
    for (double& stiffness : m.filter_stiffness) stiffness *= factor;
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

    m.settings = settings.material;
    m.mean_dilatation = settings.mean_dilatation;
    m.mixture = mix(m.sampling, settings, threads);
    spread_materials(m);

    // Mass: the volumes shared out by Shepard weights. Clipped cells as nodal masses would raise the largest frequency
    // a thousandfold.
    m.node_volumes = std::move(build.node_volumes);
    const double smallest = 1e-9 * *std::max_element(m.node_volumes.begin(), m.node_volumes.end());
    for (double& V : m.node_volumes) V = std::max(V, smallest);  // what no point sees must have a mass to divide by
    m.mass = shared_out(m, &Material::density, m.node_volumes, threads);
    for (double mass : m.mass) m.inverse_mass.push_back(1 / mass);
    m.total_mass = std::accumulate(m.mass.begin(), m.mass.end(), 0.0);
    m.node_length = m.sampling.spacing / (m.sampling.lattice == Lattice::bcc ? std::cbrt(2.0) : 1);

    const double standard = grid ? default_filter_strength : default_nodal_strength;
    m.stabilization = settings.stabilization < 0 ? standard : settings.stabilization;
    if (m.stabilization > 0) {
        if (grid) {
            m.filter = build_filter(m.sampling, m.approximation, threads);
            find_filter_stiffness(m, threads);
        } else {
            m.nodal = build_nodal(m);
        }
    }
    return m;
}

void set_material(Model& m, const Material& material, std::size_t which) {
    std::vector<double> before;
    for (std::size_t q = 0; q < m.nodal.kappa.size(); ++q) before.push_back(youngs_modulus(m, q));
    if (which == 0) m.settings = material;
    else m.mixture.materials[which] = material;
    spread_materials(m);
    for (std::size_t q = 0; q < before.size(); ++q) m.nodal.kappa[q] *= youngs_modulus(m, q) / before[q];
    if (!m.filter_stiffness.empty()) find_filter_stiffness(m, Threads(1));
}

}  // namespace phyxel
