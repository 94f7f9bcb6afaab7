#include <fmt/format.h>

#include <cmath>

#include "studies/beam.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 4: how far each solution is from that of the next coarser lattice, relative to it, in the
/// mean square over the beam. Converging says nothing about what to: that is `accuracy`.

namespace phyxel::studies {
namespace {

double difference(const std::vector<Vec3>& fine, const std::vector<Vec3>& coarse) {
    double apart = 0, all = 0;
    for (std::size_t i = 0; i < fine.size(); ++i) {
        apart += norm_squared(fine[i] - coarse[i]);
        all += norm_squared(fine[i]);
    }
    return std::sqrt(apart / all);
}

}  // namespace

int run_convergence(const Options& options) {
    Results results("convergence", {"load", "quadrature", "nodes", "tip [mm]", "difference", "error"}, options);
    const std::size_t finest = options.small ? 5 : 7;
    for (const Vec3& force : {bending, stretching})
        for (const Quadrature quadrature : {Quadrature::grid, Quadrature::nodes}) {
            const std::string load = force.z > 0 ? "stretching" : "bending";
            const std::string name = quadrature == Quadrature::grid ? "grid" : "nodes";
            std::vector<double> counts, differences;
            std::vector<Vec3> coarser;
            double error = 0;
            bool converged = true;
            for (std::size_t n = 2; n <= finest; ++n) {
                BodySettings settings = beam_settings(n);
                settings.quadrature = quadrature;
                const BeamResult beam = meshless_beam(settings, force, options.threads);
                converged = converged && beam.converged;
                results.note(beam.hash);
                if (!coarser.empty()) {
                    counts.push_back(double(beam.nodes));
                    differences.push_back(difference(beam.field, coarser));
                    results.add_row({load, name, double(beam.nodes), force.z > 0 ? beam.tip.z : beam.tip.y,
                                     differences.back(), std::abs(tip_error(beam, force))});
                }
                coarser = beam.field;
                error = std::abs(tip_error(beam, force));
            }
            results.expect(load + ", " + name + ": every solution was found", converged);
            // In three dimensions a power of the spacing is a third of it in the number of nodes; and from n to n + 1
            // cells an error of order p changes by one of order p + 1.
            results.expect_at_least(load + ", " + name + ": order of the error in the spacing, by the differences",
                                    -3 * slope_of_logarithms(counts, differences) - 1, 1);
            if (quadrature == Quadrature::grid)
                results.expect_at_most(load + ", grid: error of the finest", error, options.small ? 2.5e-3 : 1.5e-3);
        }
    return results.finish();
}

}  // namespace phyxel::studies
