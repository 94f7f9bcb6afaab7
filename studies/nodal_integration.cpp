#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "studies/beam.h"
#include "studies/results.h"
#include "world/parts.h"

/// Volumes from densities, as in Müller et al., "Point based animation of elastic, plastic and melting objects" (2004),
/// against volumes of the grid. There node i has mass m_i = s r_i^3 rho with r_i its mean distance to its ten nearest
/// neighbours and one s for all; density sum_j m_j w(|X_i - X_j|, h_i) with h_i = 3 r_i and
/// w = 315/(64 pi h^9) (h^2 - r^2)^3; volume m_i over density, in which s cancels. A node at a surface sees neighbours
/// on one side only: its density comes out too low and its volume too large, and the body too heavy and too stiff, by
/// an amount that depends on how many nodes are at surfaces.

namespace phyxel::studies {
namespace {

constexpr std::size_t nearest_count = 10;

double kernel(double distance, double h) {
    if (distance >= h) return 0;
    return 315 / (64 * std::numbers::pi * std::pow(h, 9)) * std::pow(h * h - distance * distance, 3);
}

/// [nodes] volumes from densities [m^3].
std::vector<double> volumes_from_densities(std::span<const Vec3> X) {
    std::vector<double> r(X.size()), volume(X.size());
    for (std::size_t i = 0; i < X.size(); ++i) {
        std::vector<double> distances;
        for (const Vec3& other : X) distances.push_back(norm(other - X[i]));
        // The node itself comes first.
        std::partial_sort(distances.begin(), distances.begin() + nearest_count + 1, distances.end());
        r[i] = std::accumulate(distances.begin(), distances.begin() + nearest_count + 1, 0.0) / nearest_count;
    }
    for (std::size_t i = 0; i < X.size(); ++i) {
        double density = 0;
        for (std::size_t j = 0; j < X.size(); ++j) density += std::pow(r[j], 3) * kernel(norm(X[j] - X[i]), 3 * r[i]);
        volume[i] = std::pow(r[i], 3) / density;
    }
    return volume;
}

}  // namespace

int run_nodal_integration(const Options& options) {
    Results results("nodal-integration", {"load", "volumes", "nodes", "volume", "tip [mm]", "error [%]"}, options);
    std::vector<std::size_t> sizes = {2, 3, 4, 6};
    if (options.small) sizes = {2, 3};
    const double whole = beam_size.x * beam_size.y * beam_size.z;
    for (const Vec3& force : {bending, stretching}) {
        const std::string load = force.z > 0 ? "stretching" : "bending";
        enum { grid, geometric, density };
        for (const int kind : {grid, geometric, density}) {
            const char* const names[] = {"eight points, of the grid", "one point, of the grid",
                                         "one point, from densities"};
            double error = 0, first = 0, share = 0;
            for (const std::size_t n : sizes) {
                BodySettings settings = beam_settings(n);
                if (kind != grid) settings.quadrature = Quadrature::nodes;
                const BeamResult beam = meshless_beam(settings, force, options.threads, [&](World& world, BodyId body) {
                    std::vector<double>& V = world.parts().body(body).model.volumes;
                    if (kind == density) {
                        const std::vector<double> found = volumes_from_densities(world.rest_positions(body));
                        results.expect("every node has one point", found.size() == V.size());
                        std::copy_n(found.begin(), std::min(found.size(), V.size()), V.begin());
                    }
                    share = std::accumulate(V.begin(), V.end(), 0.0) / whole;
                });
                error = 100 * tip_error(beam, force);
                if (n == sizes.front()) first = error;
                results.note(beam.hash);
                results.add_row(
                    {load, names[kind], double(beam.nodes), share, force.z > 0 ? beam.tip.z : beam.tip.y, error});
                results.expect(fmt::format("{}, {}, {} nodes: converged", load, names[kind], beam.nodes),
                               beam.converged);
                const std::string what = fmt::format("{}, {}, {} nodes", load, names[kind], beam.nodes);
                if (kind == density) {
                    results.expect_at_least(what + ": volume over the true one", share, 1.1);
                    results.expect_at_least(what + ": too stiff by [%]", -error, 8);
                } else {
                    results.expect_at_most(what + ": volume off by", std::abs(share - 1), 1e-12);
                }
            }
            if (kind == grid)
                results.expect_at_most(load + ", eight points: error of the finest [%]", std::abs(error),
                                       options.small ? 0.45 : 0.15);
            if (kind == density)
                results.expect_at_least(load + ", from densities: change of the error with the lattice [%]",
                                        std::abs(error - first), 1);
        }
    }
    return results.finish();
}

}  // namespace phyxel::studies
