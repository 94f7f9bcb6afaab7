#include "forces/mean_dilatation.h"

namespace phyxel {

void cell_means_times_lambda(const Model& m, std::span<const double> value, const Threads& threads,
                             std::vector<double>& out) {
    const DilatationCells& cells = m.dilatation;
    out.resize(cells.volume.size());
    threads.for_each(out.size(), 1024, [&](std::size_t c) {
        double sum = 0;
        for (std::uint32_t k = cells.offset[c]; k < cells.offset[c + 1]; ++k)
            sum += m.volumes[cells.points[k]] * value[cells.points[k]];
        out[c] = cells.lambda[c] * sum / cells.volume[c];
    });
}

double shared_dilatation_energy(const Model& m, std::span<const double> pressure) {
    double U = 0;
    for (std::size_t c = 0; c < pressure.size(); ++c)
        if (m.dilatation.lambda[c] != 0)
            U += 0.5 * m.dilatation.volume[c] * pressure[c] * pressure[c] / m.dilatation.lambda[c];
    return U;
}

PointStresses point_stresses(const Model& m, std::span<const Mat3> F, const Threads& threads) {
    std::vector<double> dilatations, pressure;
    if (!m.dilatation.empty()) {
        dilatations.resize(F.size());
        threads.for_each(F.size(), 1024, [&](std::size_t q) {
            if (shares_dilatation(m, q)) dilatations[q] = dilatation(m.point_material(q).law, F[q]);
        });
        cell_means_times_lambda(m, dilatations, threads, pressure);
    }
    PointStresses result;
    result.stress.resize(F.size());
    result.energy_density.resize(F.size());
    threads.for_each(F.size(), 256, [&](std::size_t q) {
        result.stress[q] = point_stress(m, q, F[q], pressure);
        result.energy_density[q] = own_energy(m, q, F[q]);
        if (!shares_dilatation(m, q)) return;
        // The cell's energy, spread evenly over its volume.
        const std::uint32_t c = m.dilatation.cell[q];
        const double lambda = m.dilatation.lambda[c];
        if (lambda != 0) result.energy_density[q] += 0.5 * pressure[c] * pressure[c] / lambda;
    });
    return result;
}

}  // namespace phyxel
