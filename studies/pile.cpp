#include <algorithm>
#include <cmath>

#include "studies/falling.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 10: bodies of several shapes fall on each other and on a floor, between walls that keep
/// them from rolling away.

namespace phyxel::studies {
namespace {

constexpr double edge = 0.1;       // [m] of a cube; the others are of its size
constexpr double pit_width = 0.3;  // [m] from wall to wall

TriangleMesh shape(int number) {
    if (number % 3 == 0) return make_box({edge, edge, edge});
    if (number % 3 == 1) return make_sphere(0.6 * edge);
    return make_torus(0.7 * edge, 0.3 * edge);
}

/// How deep the surface is in the floor or in a wall [m].
double depth(const World& world, BodyId body) {
    double deepest = 0;
    for (const Vec3f& x : world.surface(body).positions())
        deepest = std::max(
            {deepest, -double(x.y), std::abs(double(x.x)) - pit_width / 2, std::abs(double(x.z)) - pit_width / 2});
    return deepest;
}

/// Surfaces at one time after the other, for the picture.
struct Shapes {
    std::vector<std::vector<Results::Cell>> vertices;   ///< time [s], body, x, y, z [m]
    std::vector<std::vector<Results::Cell>> triangles;  ///< body, and three of its vertices

    void add(const World& world, const std::vector<BodyId>& bodies) {
        const bool first = vertices.empty();
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const Surface& surface = world.surface(bodies[i]);
            for (const Vec3f& x : surface.positions())
                vertices.push_back({world.time(), double(i), double(x.x), double(x.y), double(x.z)});
            if (!first) continue;
            for (const Triangle& t : surface.triangles())
                triangles.push_back({double(i), double(t[0]), double(t[1]), double(t[2])});
        }
    }
};

}  // namespace

int run_pile(const Options& options) {
    Results results("pile", {"time [s]", "kinetic [J]", "depth [m]", "touching", "iterations"}, options);
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
    for (const Vec3& inward : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
        world.add_collider(Plane{.point = -0.5 * pit_width * inward, .normal = inward, .friction = 0.5});

    Shapes shapes;
    shapes.add(world, bodies);
    bool completed = true;
    double now = 0, deepest = 0, nearest = 1;  // [m]
    const int steps = options.small ? 60 : 150;
    for (int step = 1; step <= steps; ++step) {
        const StepReport report = world.step();
        completed = completed && report.status == StepStatus::ok;
        now = 0;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            now = std::max(now, depth(world, bodies[i]));
            for (std::size_t j = i + 1; j < bodies.size(); ++j)
                nearest = std::min(
                    nearest, norm(world.report(bodies[i]).center_of_mass - world.report(bodies[j]).center_of_mass));
        }
        deepest = std::max(deepest, now);
        if (step == steps / 10 || step == steps / 5 || step == steps) shapes.add(world, bodies);
        if (step % 5 == 0)
            results.add_row(
                {world.time(), world.energy().kinetic, now, double(report.contacts), double(report.newton_iterations)});
    }
    results.write_table("shapes", {"time", "body", "x", "y", "z"}, shapes.vertices);
    results.write_table("triangles", {"body", "a", "b", "c"}, shapes.triangles);
    results.note(world);

    double volume = 0;
    for (BodyId body : bodies)
        volume = std::max(volume, std::abs(world.report(body).volume / world.report(body).rest_volume - 1));
    results.expect("every step was found", completed);
    const double allowed = 0.25 * world.report(bodies.front()).spacing;
    results.expect_at_most("any surface in the floor or a wall at the end, deep [m]", now, allowed);
    // Where a tower of seven bodies comes down at once, the energy of contact gives way by a third of a spacing.
    results.expect_at_most("any surface in the floor or a wall at any time, deep [m]", deepest,
                           (options.small ? 1 : 2) * allowed);
    results.expect_at_least("least distance of two centers of mass [m]", nearest, 0.3 * edge);
    results.expect_at_most("volume of any body at the end, off by", volume, 0.1);
    results.expect_at_most("energy that is not accounted for, of the largest", world.energy().balance_error, 0.01);
    return results.finish();
}

}  // namespace phyxel::studies
