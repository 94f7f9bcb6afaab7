#include <algorithm>
#include <cmath>

#include "studies/falling.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 9: a torus falls on a floor. Nodes hold the state; the surface that is seen and the
/// points that touch the floor only follow them. Contact is one smooth energy within the implicit step.

namespace phyxel::studies {
namespace {

constexpr double major = 0.1, minor = 0.04;  // [m]
constexpr double fall_duration = 2;          // [s]

void add_shape(const World& world, BodyId body, const char* when, std::vector<std::vector<Results::Cell>>& rows) {
    for (const Vec3& x : world.positions(body)) rows.push_back({when, "node", x.x, x.y, x.z});
    for (const Vec3f& x : world.surface(body).positions())
        rows.push_back({when, "surface", double(x.x), double(x.y), double(x.z)});
}

}  // namespace

int run_torus_on_floor(const Options& options) {
    Results results("torus-on-floor", {"time [s]", "lowest [m]", "center [m]", "kinetic [J]", "touching", "iterations"},
                    options);
    World world({.time_step = 1.0 / 60, .integrator = Integrator::implicit_euler, .threads = options.threads});
    BodySettings settings;
    settings.spacing = options.small ? 0.02 : 0.0125;
    settings.rotation = {{1, 0, 0}, 35};
    settings.translation = {0, 0.25, 0};
    settings.material = falling_material;
    const BodyId body = world.add_body(make_torus(major, minor), settings);
    world.add_collider(Plane{.friction = 0.5});

    std::vector<std::vector<Results::Cell>> shapes;
    add_shape(world, body, "before", shapes);
    bool completed = true;
    double deepest = 1;
    const int steps = int(std::lround(60 * fall_duration));
    for (int step = 1; step <= steps; ++step) {
        const StepReport report = world.step();
        completed = completed && report.status == StepStatus::ok;
        deepest = std::min(deepest, lowest(world, body));
        if (step % 4 == 0)
            results.add_row({world.time(), lowest(world, body), world.report(body).center_of_mass.y,
                             world.energy().kinetic, double(report.contacts), double(report.newton_iterations)});
    }
    add_shape(world, body, "after", shapes);
    results.write_table("shapes", {"when", "what", "x", "y", "z"}, shapes);
    std::vector<std::vector<Results::Cell>> triangles;
    for (const Triangle& t : world.surface(body).triangles())
        triangles.push_back({double(t[0]), double(t[1]), double(t[2])});
    results.write_table("triangles", {"a", "b", "c"}, triangles);
    results.note(world);

    const BodyReport report = world.report(body);
    const double fall = report.mass * 9.81 * 0.2;  // [J]
    results.expect("every step was found", completed);
    results.expect_at_least("lowest point of the surface over the whole time [m]", deepest, -0.25 * report.spacing);
    results.expect_at_most("height of the center at the end [m]", world.report(body).center_of_mass.y, minor + 0.005);
    results.expect_at_most("kinetic energy at the end, of what fell", world.energy().kinetic / fall, 1e-3);
    results.expect_at_most("volume at the end, off by", std::abs(report.volume / report.rest_volume - 1), 0.02);
    return results.finish();
}

}  // namespace phyxel::studies
