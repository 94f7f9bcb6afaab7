#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "studies/results.h"

/// Brunet et al. 2019 claim "large and possibly inconsistent steps" for their implicit scheme. A heavy beam falls and
/// swings with steps of 1/60 s, with steps between 1/600 and 1/6 s at random, and with steps of half a second, by the
/// nonlinear implicit Euler method and by the second order formula (BDF2). No step may fail, energy may only fall, and
/// the beam must come to rest where statics says.

namespace phyxel::studies {
namespace {

constexpr Vec3 beam = {0.1, 0.1, 1};
constexpr double swing_duration = 10;  // [s]

/// Of the way of a free step, which half a second makes 2.5 m: with the default of 3e-3 the beam would rest half a
/// hundredth of its length off.
constexpr double step_tolerance = 1e-3;

/// The lengths of the steps, one by one.
std::vector<double> step_lengths(const std::string& kind) {
    std::mt19937 random(2019);
    std::vector<double> lengths;
    for (double time = 0; time < swing_duration - 1e-9; time += lengths.back()) {
        const double uniform = double(random()) / double(std::mt19937::max());
        const double length = kind == "1/60 s" ? 1.0 / 60 : kind == "0.5 s" ? 0.5 : std::pow(100.0, uniform) / 600;
        lengths.push_back(std::min(length, swing_duration - time));
    }
    return lengths;
}

/// The beam, held at z = 0, in a world that steps as long as it is told to.
struct HeavyBeam {
    World world;
    BodyId body;
    std::size_t tip;

    HeavyBeam(Integrator integrator, std::size_t cells, int threads)
        : world({.time_step = 1,
                 .integrator = integrator,
                 .mass_damping = 2,
                 .solver = {.tolerance = integrator == Integrator::statics ? 0 : step_tolerance},
                 .threads = threads}) {
        BodySettings settings;
        settings.spacing = beam.x / double(cells);
        settings.translation = 0.5 * beam;
        settings.material = corotated({.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3});
        body = world.add_body(make_box(beam), settings);
        world.add_fix(body, {.box = {{-1, -1, -1e-9}, {1, 1, 1e-9}}});
        tip = world.add_probe(body, {beam.x / 2, beam.y / 2, beam.z});
    }
    double height() const { return world.probe(tip).position.y - beam.y / 2; }
    double energy() const {
        const EnergyLedger e = world.energy();
        return e.kinetic + e.elastic + e.stabilization + e.constraint + e.gravitational;
    }
};

}  // namespace

int run_irregular_steps(const Options& options) {
    Results results("irregular-steps",
                    {"scheme", "steps", "number", "cut", "shortest [s]", "longest [s]", "iterations", "deepest [m]",
                     "last [m]", "energy gained"},
                    options);
    const std::size_t cells = options.small ? 2 : 3;
    HeavyBeam rest(Integrator::statics, cells, options.threads);
    results.expect("statics converged", rest.world.step().status == StepStatus::ok);
    std::vector<std::vector<Results::Cell>> paths;
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2})
        for (const std::string kind : {"1/60 s", "random", "0.5 s"}) {
            const std::string scheme = integrator == Integrator::bdf2 ? "BDF2" : "implicit Euler";
            const std::vector<double> lengths = step_lengths(kind);
            HeavyBeam swinging(integrator, cells, options.threads);
            double least = swinging.energy(), gained = 0, iterations = 0, deepest = 0;
            bool completed = true;
            std::size_t retries = 0;
            for (const double length : lengths) {
                const StepReport report = swinging.world.advance(length);
                completed = completed && report.status == StepStatus::ok;
                retries += report.retries;
                iterations += double(report.newton_iterations) / double(lengths.size());
                deepest = std::min(deepest, swinging.height());
                gained = std::max(gained, swinging.energy() - least);
                least = std::min(least, swinging.energy());
                paths.push_back({scheme + ", " + kind, swinging.world.time(), swinging.height()});
            }
            results.note(swinging.world);
            const double drop = 9.81 * 10 * 0.5;  // [J] weight times half the length: what the motion is made of
            results.add_row({scheme, kind, double(lengths.size()), double(retries),
                             *std::min_element(lengths.begin(), lengths.end()),
                             *std::max_element(lengths.begin(), lengths.end()), iterations, deepest, swinging.height(),
                             gained / drop});
            const std::string what = scheme + ", " + kind;
            results.expect(what + ": every step was found", completed);
            results.expect_at_most(what + ": steps cut into smaller ones", double(retries), 0);
            results.expect_at_most(what + ": last height against statics [m]",
                                   std::abs(swinging.height() - rest.height()), 2e-3);
            if (integrator == Integrator::implicit_euler)
                results.expect_at_most(what + ": energy gained, of the weight's work", gained / drop, 1e-3);
        }
    results.write_table("paths", {"run", "time [s]", "height [m]"}, paths);
    return results.finish();
}

}  // namespace phyxel::studies
