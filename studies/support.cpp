#include <fmt/format.h>

#include <cmath>

#include "studies/beam.h"
#include "studies/results.h"

/// How large should neighbourhoods be? Brunet et al. 2019 leave it open. Error of both beams against the support radius
/// in spacings: small ones are stiff, large ones soften the clamp and cost with the cube of the radius.

namespace phyxel::studies {

int run_support(const Options& options) {
    Results results("support", {"load", "nodes", "support", "neighbors", "error [%]", "time [s]"}, options);
    std::vector<double> supports = {1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0};
    if (options.small) supports = {1.6, 2.2, 2.7};
    const std::vector<std::size_t> sizes =
        options.small ? std::vector<std::size_t>{2} : std::vector<std::size_t>{2, 3, 4};
    for (const Vec3& force : {bending, stretching})
        for (const std::size_t n : sizes) {
            const std::string load = force.z > 0 ? "stretching" : "bending";
            double at_default = 0, narrow = 0, wide = 0;
            for (const double support : supports) {
                BodySettings settings = beam_settings(n);
                settings.kernel.support = support;
                double neighbors = 0;
                const BeamResult beam = meshless_beam(settings, force, options.threads, [&](World& world, BodyId body) {
                    neighbors = world.report(body).mean_neighbors;
                });
                const double error = 100 * tip_error(beam, force);
                results.note(beam.hash);
                results.add_row({load, double(beam.nodes), support, neighbors, error, beam.seconds});
                results.expect(fmt::format("{}, {} nodes, support {}: converged", load, beam.nodes, support),
                               beam.converged);
                if (support == 1.6) narrow = error;
                if (support == 2.2) at_default = error;
                if (support == 2.7) wide = error;
            }
            const std::string what = fmt::format("{}, {} nodes", load, beam_nodes(n));
            results.expect_at_most(what + ": the default of 2.2 spacings errs by [%]", std::abs(at_default), 0.8);
            if (force.z > 0) continue;
            results.expect_at_most(what + ": 1.6 spacings are stiffer, by [%]", narrow - at_default, 0);
            results.expect_at_least(what + ": 2.7 spacings are softer, by [%]", wide - at_default, 0);
        }
    return results.finish();
}

}  // namespace phyxel::studies
