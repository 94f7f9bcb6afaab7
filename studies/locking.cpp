#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "studies/beam.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 7, and beyond: the bent beam with Poisson's ratio going to one half. Low order elements
/// stiffen ("lock") because every point asks for its own volume to be kept and there are more points than freedoms.

namespace phyxel::studies {
namespace {

using fem::ElementType;
using fem::Split;

/// A ratio with what triquadratic hexahedra converge to [mm], and what the meshless beam may err [%].
struct Ratio {
    double nu, tip, allowed;
};
constexpr Ratio ratios[] = {{0.45, bent_tip, 0.25}, {0.49, -45.02, 1.5}, {0.499, -44.9, 3}, {0.4999, -44.9, 5}};

}  // namespace

int run_locking(const Options& options) {
    Results results("locking", {"method", "nu", "nodes", "tip y [mm]", "tip x [mm]", "error [%]"}, options);
    const auto add = [&](const std::string& method, const Ratio& ratio, const BeamResult& beam) {
        const double error = 100 * tip_error(beam, bending, ratio.tip);
        results.add_row({method, ratio.nu, double(beam.nodes), beam.tip.y, beam.tip.x, error});
        results.expect(fmt::format("nu = {}, {}: converged", ratio.nu, method), beam.converged);
        return error;
    };
    for (const Ratio& ratio : ratios) {
        const std::size_t n = options.small ? 2 : 4;
        if (options.small && ratio.nu > 0.495) break;
        Material material = beam_material;
        material.poissons_ratio = ratio.nu;
        const auto meshless = [&](std::optional<bool> mean_dilatation) {
            BodySettings settings = beam_settings(n, material);
            settings.mean_dilatation = mean_dilatation;
            const BeamResult beam = meshless_beam(settings, bending, options.threads);
            results.note(beam.hash);
            return beam;
        };
        const double error = add("meshless", ratio, meshless({}));
        results.expect_at_most(fmt::format("nu = {}, meshless, error [%]", ratio.nu), std::abs(error),
                               options.small ? std::max(ratio.allowed, 1.5) : ratio.allowed);
        add("meshless, dilatation not shared", ratio, meshless(false));
        const auto elements = [&](const std::string& method, ElementType type, Split split) {
            return add(method, ratio, element_beam(type, n, bending, material, split));
        };
        elements("27-node hexahedra", ElementType::hexahedra_27, Split::six);
        elements("8-node hexahedra", ElementType::hexahedra_8, Split::six);
        const double one = elements("tetrahedra", ElementType::tetrahedra, Split::six);
        const double other = elements("mirrored tetrahedra", ElementType::tetrahedra, Split::six_mirrored);
        results.expect_at_most(fmt::format("nu = {}, tetrahedra and their mirror image, difference [%]", ratio.nu),
                               std::abs(one - other), 1e-4);
    }
    return results.finish();
}

}  // namespace phyxel::studies
