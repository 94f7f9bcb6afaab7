#include <fmt/format.h>

#include <cmath>

#include "studies/beam.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 2: with linear strain a rotation is taken for a deformation, which makes forces from
/// nowhere and bodies that grow. The beam is bent by rising forces, and turned as a whole by the grip that holds its
/// end, with the linear and with the corotated law.

namespace phyxel::studies {
namespace {

struct Found {
    double tip = 0, volume = 1, energy = 0;  ///< [mm], over the rest volume, [J]
    bool converged = false;
};

/// The beam under a share of the bending force, its clamp turned about x.
Found solve(std::size_t n, Law law, double share, double degrees, const Options& options, Results& results) {
    World world({.time_step = 1, .gravity = {}, .integrator = Integrator::statics, .threads = options.threads});
    const BodyId body = world.add_body(make_box(beam_size), beam_settings(n, with_law(beam_material, law)));
    world.add_fix(body, {.box = {{-1, -1, -1e-9}, {1, 1, 1e-9}},
                         .axis = {1, 0, 0},
                         .center = 0.5 * Vec3{beam_size.x, beam_size.y, 0},
                         .path = {{0, {}, 0}, {1, {}, degrees}}});
    if (share > 0) world.add_load(body, {.box = {{-1, -1, beam_size.z - 1e-9}, {1, 1, 1}}, .force = share * bending});
    const std::size_t tip = world.add_probe(body, {beam_size.x / 2, beam_size.y / 2, beam_size.z});
    Found found;
    found.converged = world.step().status == StepStatus::ok;
    found.tip = 1e3 * (world.probe(tip).position - world.probe(tip).rest).y;
    found.volume = world.report(body).volume / world.report(body).rest_volume;
    found.energy = world.energy().elastic;
    results.note(world);
    return found;
}

}  // namespace

int run_ghost_forces(const Options& options) {
    Results results("ghost-forces", {"law", "force [N]", "turn [deg]", "tip y [mm]", "volume", "energy [J]"}, options);
    const std::size_t n = options.small ? 2 : 4;
    for (const Law law : {Law::linear, Law::corotated}) {
        const std::string name = law == Law::linear ? "linear" : "corotated";
        Found bent, turned;
        const auto add = [&](double share, double degrees) {
            const Found found = solve(n, law, share, degrees, options, results);
            results.add_row({name, 12 * share, degrees, found.tip, found.volume, found.energy});
            results.expect(fmt::format("{}, {:g} N, {:g} degrees: converged", name, 12 * share, degrees),
                           found.converged);
            return found;
        };
        for (const double share : {0.5, 1.0, 2.0, 4.0}) {
            const Found found = add(share, 0);
            if (share == 1) bent = found;
        }
        for (const double degrees : {15., 30., 45., 60.}) turned = add(0, degrees);
        if (law == Law::linear) {
            results.expect_at_least("linear, bent by 12 N: grows to, of its volume", bent.volume, 1.01);
            results.expect_at_least("linear, turned by 60 degrees: energy from nowhere [J]", turned.energy, 1);
        } else {
            results.expect_at_most("corotated, bent by 12 N: volume off by", std::abs(bent.volume - 1), 3e-3);
            results.expect_at_most("corotated, turned by 60 degrees: energy from nowhere [J]", turned.energy, 1e-9);
            results.expect_at_most("corotated, turned by 60 degrees: volume off by", std::abs(turned.volume - 1), 1e-9);
        }
    }
    return results.finish();
}

}  // namespace phyxel::studies
