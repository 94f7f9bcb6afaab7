#include "studies/beam.h"

#include "studies/results.h"

namespace phyxel::studies {

BodySettings beam_settings(std::size_t n, const Material& material) {
    BodySettings settings;
    settings.translation = 0.5 * beam_size;
    settings.spacing = beam_spacing(n);
    settings.material = material;
    return settings;
}

BeamResult meshless_beam(const BodySettings& settings, const Vec3& force, int threads,
                         const std::function<void(World&, BodyId)>& change) {
    World world({.gravity = {}, .integrator = Integrator::statics, .threads = threads});
    const BodyId body = world.add_body(make_box(beam_size), settings);
    world.add_fix(body, {.box = {{-1, -1, -1e-9}, {1, 1, 1e-9}}});
    world.add_load(body, {.box = {{-1, -1, beam_size.z - 1e-9}, {1, 1, 1}}, .force = force});
    const std::size_t tip = world.add_probe(body, {beam_size.x / 2, beam_size.y / 2, beam_size.z});
    std::vector<std::size_t> places;
    for (int k = 0; k <= 10; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                places.push_back(world.add_probe(
                    body, {beam_size.x * (1 + 2 * i) / 6, beam_size.y * (1 + 2 * j) / 6, beam_size.z * k / 10}));
    if (change) change(world, body);
    const double start = processor_seconds();
    const StepReport report = world.step();
    BeamResult result;
    result.seconds = processor_seconds() - start;
    result.nodes = world.positions(body).size();
    result.tip = 1e3 * (world.probe(tip).position - world.probe(tip).rest);
    result.iterations = report.newton_iterations;
    result.converged = report.status == StepStatus::ok;
    result.hash = world.state_hash();
    for (const std::size_t place : places)
        result.field.push_back(1e3 * (world.probe(place).position - world.probe(place).rest));
    return result;
}

BeamResult element_beam(fem::ElementType type, std::size_t n, const Vec3& force, const Material& material,
                        fem::Split split) {
    using namespace fem;
    const std::size_t cells = type == ElementType::hexahedra_27 ? n / 2 : n;
    const Solid solid(box_mesh(type, {cells, cells, 10 * cells}, beam_size, split), material);
    Conditions conditions(solid);
    clamp(conditions, solid, Face::z_min);
    add_face_force(conditions, solid, Face::z_max, force);
    const double start = processor_seconds();
    const StaticResult found = solve_static(solid, conditions);
    BeamResult result;
    result.seconds = processor_seconds() - start;
    result.nodes = solid.mesh.X.size();
    result.tip = 1e3 * interpolate(solid.mesh, found.displacement, {beam_size.x / 2, beam_size.y / 2, beam_size.z});
    result.iterations = std::size_t(found.iterations);
    result.converged = found.converged;
    return result;
}

double tip_error(const BeamResult& beam, const Vec3& force, double reference) {
    return (force.z > 0 ? beam.tip.z : beam.tip.y) / reference - 1;
}

}  // namespace phyxel::studies
