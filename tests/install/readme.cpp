// The lines of the README, as a program of another project: a bunny falls for one frame.
#include <phyxel/phyxel.h>

#include <cmath>
#include <cstdio>

int main() {
    phyxel::World world({.time_step = 1.0 / 60, .gravity = {0, -9.81, 0}});
    auto bunny = world.add_body(
        phyxel::read_mesh(PHYXEL_MESH),
        {
            .scale = 0.01,
            .spacing = 0.005,
            .material = phyxel::neo_hookean({.density = 1000, .youngs_modulus = 2e5, .poissons_ratio = 0.45}),
        });
    world.add_collider(phyxel::Plane{.point = {0, -1, 0}, .normal = {0, 1, 0}});
    const phyxel::Vec3f before = world.surface(bunny).positions().front();
    phyxel::StepReport report = world.step();
    const phyxel::Vec3f after = world.surface(bunny).positions().front();

    std::printf("%zu substeps, the first vertex fell by %g m\n", report.substeps, double(before.y - after.y));
    const double expected = 9.81 / 3600;  // an implicit Euler step falls by g dt^2
    return report.status == phyxel::StepStatus::ok && std::abs(double(before.y - after.y) - expected) < 0.2 * expected
               ? 0
               : 1;
}
