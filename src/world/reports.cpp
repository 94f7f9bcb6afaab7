#include <algorithm>
#include <cmath>

#include "forces/mean_dilatation.h"
#include "material/stress_measures.h"
#include "phyxel/world.h"
#include "world/parts.h"

namespace phyxel {

EnergyLedger World::Parts::ledger() {
    EnergyLedger sum;
    Exchanged exchanged;
    double start = 0, gravity_at_start = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        DynamicBody& body = *bodies[i];
        const BodyEnergy e = body_energy(body, around, threads);
        sum.kinetic += e.kinetic;
        sum.elastic += e.elastic;
        sum.stabilization += e.stabilization;
        sum.gravitational += e.gravitational;
        sum.contact += e.contact;
        sum.constraint += e.constraint;
        exchanged.external += body.exchanged.external;
        exchanged.damping += body.exchanged.damping;
        exchanged.friction += body.exchanged.friction;
        exchanged.numerical += body.exchanged.numerical;
        start += infos[i].energy_at_start;
        gravity_at_start += infos[i].gravity_at_start;
    }
    sum.external_work = exchanged.external;
    sum.damping = exchanged.damping;
    sum.friction = exchanged.friction;
    sum.numerical = exchanged.numerical;
    const double stored = sum.kinetic + sum.elastic + sum.stabilization + sum.contact + sum.constraint;
    const double lost = sum.damping + sum.friction + sum.numerical;
    largest_energy = std::max({largest_energy, stored, std::abs(sum.gravitational - gravity_at_start),
                               std::abs(sum.external_work), std::abs(lost)});
    const double missing = stored + sum.gravitational + lost - sum.external_work - start;
    sum.balance_error = largest_energy > 0 ? std::abs(missing) / largest_energy : 0;
    return sum;
}

void World::Parts::note_energy() {
    double kinetic = 0, fallen = 0, external = 0, lost = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const DynamicBody& b = *bodies[i];
        kinetic += kinetic_energy(b, threads);
        fallen -= infos[i].gravity_at_start;
        fallen -= threads.sum(b.state.x.size(), 1024,
                              [&](std::size_t n) { return b.model.mass[n] * dot(around.gravity, b.state.x[n]); });
        external += b.exchanged.external;
        lost += b.exchanged.damping + b.exchanged.friction + b.exchanged.numerical;
    }
    largest_energy = std::max({largest_energy, kinetic, std::abs(fallen), std::abs(external), std::abs(lost)});
}

EnergyLedger World::energy() const { return parts_->ledger(); }

BodyReport World::report(BodyId id) const {
    const std::size_t index = parts_->index_of(id);
    const DynamicBody& body = *parts_->bodies[index];
    const Model& m = body.model;
    BodyReport r;
    r.nodes = m.rest.size();
    r.quadrature_points = m.volumes.size();
    r.mean_neighbors = static_cast<double>(m.stencils.pairs()) / static_cast<double>(m.stencils.points());
    r.spacing = m.sampling.spacing;
    r.mass = m.total_mass;
    r.rest_volume = m.sampling.clipped_volume;
    r.mesh_volume = parts_->infos[index].mesh_report.volume;
    const std::vector<Mat3> F = deformation_gradients(m, body.state.x, parts_->threads);
    r.volume = parts_->threads.sum(F.size(), 1024, [&](std::size_t q) { return m.volumes[q] * determinant(F[q]); });
    for (int c = 0; c < 3; ++c)
        r.center_of_mass[c] = parts_->threads.sum(m.mass.size(), 1024, [&](std::size_t i) {
            return m.mass[i] * body.state.x[i][c];
        }) / m.total_mass;
    return r;
}

PointFields World::point_fields(BodyId id) const {
    const DynamicBody& body = parts_->body(id);
    const Model& m = body.model;
    const EmbeddedPoints points =
        embed(m.sampling, m.approximation, m.sampling.points, m.sampling.point_cell, Gradients::no, parts_->threads);
    PointFields fields;
    fields.volumes = m.volumes;
    fields.deformation_gradient = deformation_gradients(m, body.state.x, parts_->threads);
    const std::size_t n = m.volumes.size();
    fields.positions.resize(n);
    fields.cauchy_stress.resize(n);
    fields.von_mises.resize(n);
    fields.principal_stress.resize(n);
    PointStresses stresses = point_stresses(m, fields.deformation_gradient, parts_->threads);
    fields.energy_density = std::move(stresses.energy_density);
    parts_->threads.for_each(n, 256, [&](std::size_t q) {
        const Mat3& F = fields.deformation_gradient[q];
        fields.positions[q] = points.position(q, body.state.x);
        fields.cauchy_stress[q] = cauchy_stress(F, stresses.stress[q]);
        fields.von_mises[q] = von_mises(fields.cauchy_stress[q]);
        fields.principal_stress[q] = principal(fields.cauchy_stress[q]);
    });
    return fields;
}

std::vector<float> World::surface_von_mises(BodyId id) const {
    const DynamicBody& body = parts_->body(id);
    const Model& m = body.model;
    // Averages over the points of each node's cells, carried to the vertices by the shape functions: the gradient at
    // the surface itself is the least accurate there is.
    std::vector<double> weighted(m.rest.size()), volume(m.rest.size());
    const std::vector<Mat3> F = deformation_gradients(m, body.state.x, parts_->threads);
    const PointStresses stresses = point_stresses(m, F, parts_->threads);
    for (std::size_t q = 0; q < F.size(); ++q) {
        const double value = von_mises(cauchy_stress(F[q], stresses.stress[q]));
        for (std::uint32_t node : m.sampling.cell_nodes[m.sampling.point_cell[q]]) {
            if (node == no_index) continue;
            weighted[node] += m.volumes[q] * value;
            volume[node] += m.volumes[q];
        }
    }
    const EmbeddedPoints& points = body.surface->points();
    std::vector<float> values(points.size());
    parts_->threads.for_each(values.size(), 256, [&](std::size_t v) {
        double sum = 0;
        for (std::uint32_t k = points.offset[v]; k < points.offset[v + 1]; ++k) {
            const std::uint32_t node = points.node[k];
            if (volume[node] > 0) sum += points.phi[k] * weighted[node] / volume[node];
        }
        values[v] = static_cast<float>(std::max(0.0, sum));
    });
    return values;
}

}  // namespace phyxel
