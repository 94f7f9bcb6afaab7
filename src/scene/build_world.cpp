#include "scene/build_world.h"

#include <string_view>

#include "phyxel/error.h"
#include "world/make_body.h"

namespace phyxel {
namespace {

/// Runs `make`; its errors are told as those of a place of the scene.
template <class Make>
auto at(const Scene& scene, const Place& place, Make&& make) {
    try {
        return make();
    } catch (const Error& error) {
        scene.text->fail(place, error.what());
    }
}

TriangleMesh make_shape(const BoxShape& box) { return make_box(box.sides); }
TriangleMesh make_shape(const SphereShape& sphere) { return make_sphere(sphere.radius); }
TriangleMesh make_shape(const CylinderShape& cylinder) { return make_cylinder(cylinder.radius, cylinder.height); }
TriangleMesh make_shape(const TorusShape& torus) { return make_torus(torus.major, torus.minor); }

TriangleMesh load(const Scene& scene, const MeshFile& file) {
    return read_mesh(scene.text->path().parent_path() / file.path, file.part);
}

TriangleMesh load_surface(const Scene& scene, const SceneBody& body) {
    if (const auto* shape = std::get_if<Shape>(&body.surface))
        return std::visit([](const auto& s) { return make_shape(s); }, *shape);
    return load(scene, std::get<MeshFile>(body.surface));
}

/// The body's settings with its contact surface and with the meshes of its regions, these in rest space.
BodySettings complete_settings(const Scene& scene, const SceneBody& body) {
    BodySettings settings = body.settings;
    if (body.contact_mesh)
        settings.contact_mesh = at(scene, body.contact_place, [&] { return load(scene, *body.contact_mesh); });
    for (std::size_t r = 0; r < body.regions.size(); ++r) {
        const SceneRegion& region = body.regions[r];
        if (!region.mesh) continue;
        const TriangleMesh mesh = at(scene, region.place, [&] { return load(scene, *region.mesh); });
        settings.regions[r].shape =
            placed(mesh, {.scale = region.scale, .rotation = region.rotation, .translation = region.translation});
    }
    return settings;
}

/// What a body is refused for is told by the words of the message alone: its mesh, its spacing, or anything else.
const Place& place_of(const SceneBody& body, std::string_view message) {
    if (message.find("contact_mesh: ") != message.npos) return body.contact_place;
    if (message.find("cannot be simulated") != message.npos) return body.surface_place;
    if (message.find("spacing of") != message.npos) return body.sampling_place;
    return body.place;
}

BodyId add_body(const Scene& scene, const SceneBody& body, const BodySettings& settings, const TriangleMesh& mesh,
                World& world) {
    try {
        return world.add_body(mesh, settings);
    } catch (const Error& error) {
        scene.text->fail(place_of(body, error.what()), error.what());
    }
}

WorldSettings world_settings(const SceneSimulation& simulation, int threads) {
    WorldSettings settings;
    settings.time_step = simulation.time_step.value_or(1 / simulation.frame_rate);
    settings.gravity = simulation.gravity;
    settings.integrator = simulation.integrator;
    settings.mass_damping = simulation.mass_damping;
    settings.stiffness_damping = simulation.stiffness_damping;
    settings.solver = simulation.solver;
    settings.threads = threads;
    return settings;
}

}  // namespace

BuiltScene build_world(const Scene& scene, int threads) {
    // All meshes first: a missing file is found before any body is sampled
    std::vector<TriangleMesh> meshes;
    std::vector<BodySettings> settings;
    for (const SceneBody& body : scene.bodies) {
        meshes.push_back(at(scene, body.surface_place, [&] { return load_surface(scene, body); }));
        settings.push_back(complete_settings(scene, body));
    }

    BuiltScene built{World(world_settings(scene.simulation, threads)), {}, {}, {}};
    for (const SceneCollider& collider : scene.colliders)
        at(scene, collider.place, [&] {
            return std::visit([&](const auto& shape) { return built.world.add_collider(shape); }, collider.shape);
        });
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        built.bodies.push_back(add_body(scene, scene.bodies[i], settings[i], meshes[i], built.world));
    for (const SceneFix& fix : scene.fixes)
        built.fixes.push_back(
            at(scene, fix.place, [&] { return built.world.add_fix(built.bodies[fix.body], fix.fix); }));
    for (const SceneLoad& load : scene.loads)
        at(scene, load.place, [&] { return built.world.add_load(built.bodies[load.body], load.load); });
    for (const SceneProbe& probe : scene.probes)
        built.probes.push_back(
            at(scene, probe.place, [&] { return built.world.add_probe(built.bodies[probe.body], probe.point); }));
    return built;
}

}  // namespace phyxel
