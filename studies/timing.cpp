#include <fmt/format.h>

#include <algorithm>

#include "studies/beam.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 6: time to solve both beams. The meshless beam is solved by Newton's method with
/// preconditioned conjugate gradients, the finite elements of `reference/fem` by Newton's method with a sparse direct
/// solver: plain code, for the shape of its curve rather than its height.

namespace phyxel::studies {

int run_timing(const Options& options) {
    using fem::ElementType;
    Results results("timing", {"load", "method", "nodes", "time [s]", "iterations", "s an iteration"}, options);
    std::vector<std::size_t> sizes = {2, 3, 4, 6, 9};
    if (options.small) sizes = {2, 3};
    const int repetitions = 2;
    for (const Vec3& force : {bending, stretching}) {
        const std::string load = force.z > 0 ? "stretching" : "bending";
        std::vector<double> counts, times;
        const auto add = [&](const std::string& method, auto&& solve) {
            BeamResult beam = solve();
            for (int r = 1; r < repetitions; ++r) beam.seconds = std::min(beam.seconds, solve().seconds);
            results.add_row({load, method, double(beam.nodes), beam.seconds, double(beam.iterations),
                             beam.seconds / double(beam.iterations)});
            results.expect(fmt::format("{}, {}, {} nodes: converged", load, method, beam.nodes), beam.converged);
            return beam;
        };
        for (const std::size_t n : sizes) {
            const BeamResult beam = add("meshless", [&] {
                return meshless_beam(beam_settings(n), force, options.threads > 0 ? options.threads : 1);
            });
            results.note(beam.hash);
            counts.push_back(double(beam.nodes));
            times.push_back(beam.seconds);
        }
        if (!options.small)
            results.expect_at_most(load + ", meshless: time grows with the nodes to the power of",
                                   slope_of_logarithms(counts, times), 1.4);
        for (const std::size_t n : sizes) {
            if (n > 4) break;
            add("8-node hexahedra", [&] { return element_beam(ElementType::hexahedra_8, n, force); });
            if (n % 2 == 0) add("27-node hexahedra", [&] { return element_beam(ElementType::hexahedra_27, n, force); });
            add("tetrahedra", [&] { return element_beam(ElementType::tetrahedra, n, force); });
        }
    }
    return results.finish();
}

}  // namespace phyxel::studies
