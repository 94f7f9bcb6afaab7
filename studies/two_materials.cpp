#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "studies/results.h"

/// Brunet et al. 2019, figure 8: a cylinder held at its middle hangs under its weight; its left half is a hundred times
/// stiffer than its right half. Each half should hang nearly as in a cylinder of its material alone: nearly, for what
/// is held is a ring of the surface, and the core beneath it yields to both sides.

namespace phyxel::studies {
namespace {

constexpr double radius = 0.05, length = 0.6, ring = 0.04;  // [m]
constexpr double stiff = 2e7, soft = 2e5;                   // Young's moduli [Pa]
constexpr int places = 24;                                  ///< along the axis

Material material(double youngs_modulus) {
    return corotated({.density = 1000, .youngs_modulus = youngs_modulus, .poissons_ratio = 0.4});
}

struct Bent {
    double heights[places + 1];  ///< [m] of the axis, from left to right
    bool converged;
};

/// The cylinder with the materials of its halves.
Bent hang(double left, double right, double transition, const Options& options, Results& results) {
    World world({.integrator = Integrator::statics, .threads = options.threads});
    BodySettings settings;
    settings.rotation = {{0, 0, 1}, 90};  // axis y to x
    settings.spacing = options.small ? 0.025 : 0.02;
    settings.material = material(right);
    if (left != right) settings.regions.push_back({BoxRegion{{-1, -1, -1}, {0, 1, 1}}, material(left), transition});
    const BodyId body = world.add_body(make_cylinder(radius, length), settings);
    world.add_fix(body, {.box = {{-ring / 2, -1, -1}, {ring / 2, 1, 1}}});
    std::size_t probes[places + 1];
    const double near = 0.998 * length / 2;  // the very end is an edge of the mesh
    const auto x = [&](int k) { return near * (2.0 * k / places - 1); };
    for (int k = 0; k <= places; ++k) probes[k] = world.add_probe(body, {x(k), 0, 0});
    Bent bent{{}, world.step().status == StepStatus::ok};
    for (int k = 0; k <= places; ++k) bent.heights[k] = world.probe(probes[k]).position.y;
    results.note(world);
    return bent;
}

}  // namespace

int run_two_materials(const Options& options) {
    Results results("two-materials", {"cylinder", "x [m]", "height [m]"}, options);
    const auto add = [&](const std::string& name, double left, double right, double transition) {
        const Bent bent = hang(left, right, transition, options, results);
        for (int k = 0; k <= places; ++k) results.add_row({name, length / 2 * (2.0 * k / places - 1), bent.heights[k]});
        results.expect(name + ": converged", bent.converged);
        return bent;
    };
    const Bent both = add("left stiff, right soft", stiff, soft, 0);
    const Bent smooth = add("with a transition of 0.2 m", stiff, soft, 0.2);
    const Bent soft_alone = add("soft alone", soft, soft, 0);
    const Bent stiff_alone = add("stiff alone", stiff, stiff, 0);
    const auto apart = [](double a, double b) { return std::abs(a / b - 1); };
    results.expect_at_most("right end against soft alone, relative difference",
                           apart(both.heights[places], soft_alone.heights[places]), 0.2);
    results.expect_at_most("left end against stiff alone, relative difference",
                           apart(both.heights[0], stiff_alone.heights[0]), 0.2);
    results.expect_at_least("right end over left end", both.heights[places] / both.heights[0], 50);
    results.expect("a transition stiffens the soft half", smooth.heights[places] > both.heights[places]);
    return results.finish();
}

}  // namespace phyxel::studies
