#include <algorithm>
#include <cmath>

#include "studies/falling.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 10: bodies of several shapes fall on each other and on a floor.

namespace phyxel::studies {
namespace {

constexpr double edge = 0.1;  // [m] of a cube; the others are of its size

TriangleMesh shape(int number) {
    if (number % 3 == 0) return make_box({edge, edge, edge});
    if (number % 3 == 1) return make_sphere(0.6 * edge);
    return make_torus(0.7 * edge, 0.3 * edge);
}

}  // namespace

int run_pile(const Options& options) {
    Results results("pile", {"time [s]", "kinetic [J]", "touching", "iterations"}, options);
    World world({.time_step = 1.0 / 60, .integrator = Integrator::implicit_euler, .threads = options.threads});
    const int count = options.small ? 3 : 7;
    std::vector<BodyId> bodies;
    for (int k = 0; k < count; ++k) {
        BodySettings settings;
        settings.spacing = options.small ? 0.03 : 0.02;
        settings.rotation = {{1, 1, 0}, 20.0 * k};
        settings.translation = {0.02 * std::sin(2.0 * k), 0.08 + 0.16 * k, 0.02 * std::cos(2.0 * k)};
        settings.material = falling_material;
        bodies.push_back(world.add_body(shape(k), settings));
    }
    world.add_collider(Plane{.friction = 0.5});

    bool completed = true;
    double deepest = 1, nearest = 1;
    const int steps = options.small ? 60 : 150;
    for (int step = 1; step <= steps; ++step) {
        const StepReport report = world.step();
        completed = completed && report.status == StepStatus::ok;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            deepest = std::min(deepest, lowest(world, bodies[i]));
            for (std::size_t j = i + 1; j < bodies.size(); ++j)
                nearest = std::min(
                    nearest, norm(world.report(bodies[i]).center_of_mass - world.report(bodies[j]).center_of_mass));
        }
        if (step % 5 == 0)
            results.add_row(
                {world.time(), world.energy().kinetic, double(report.contacts), double(report.newton_iterations)});
    }
    std::vector<std::vector<Results::Cell>> shapes;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (const Vec3f& x : world.surface(bodies[i]).positions())
            shapes.push_back({double(i), double(x.x), double(x.y), double(x.z)});
    results.write_table("shapes", {"body", "x", "y", "z"}, shapes);
    results.note(world);

    double volume = 0;
    for (BodyId body : bodies)
        volume = std::max(volume, std::abs(world.report(body).volume / world.report(body).rest_volume - 1));
    results.expect("every step was found", completed);
    results.expect_at_least("lowest point of any surface over the whole time [m]", deepest,
                            -0.25 * world.report(bodies.front()).spacing);
    results.expect_at_least("least distance of two centers of mass [m]", nearest, 0.3 * edge);
    results.expect_at_most("volume of any body at the end, off by", volume, 0.1);
    results.expect_at_most("energy that is not accounted for, of the largest", world.energy().balance_error, 0.01);
    return results.finish();
}

}  // namespace phyxel::studies
