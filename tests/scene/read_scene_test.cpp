#include "scene_file.h"

namespace phyxel {
namespace {

Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    TemporaryFolder folder;
    return read_scene(folder.write("scene.toml", text), overrides);
}

const char* const least_scene = R"(
[[material]]
name = "jelly"
preset = "jelly"
[[body]]
name = "ball"
shape = { sphere = 0.1 }
material = "jelly"
)";

TEST(ReadScene, every_key_of_a_full_scene_arrives) {
    const Scene scene = read(good_scene);
    EXPECT_EQ(scene.title, "Everything");
    EXPECT_EQ(scene.simulation.integrator, Integrator::verlet);
    EXPECT_FALSE(scene.simulation.time_step.has_value());
    EXPECT_EQ(scene.simulation.duration, 0.5);
    EXPECT_EQ(scene.simulation.frame_rate, 30);
    EXPECT_EQ(scene.simulation.mass_damping, 0.25);
    EXPECT_EQ(scene.simulation.stiffness_damping, 1e-3);

    const Material jelly{.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.45, .law = Law::corotated};
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].material, jelly);

    ASSERT_EQ(scene.bodies.size(), 1u);
    const BodySettings& body = scene.bodies[0].settings;
    EXPECT_EQ(std::get<BoxShape>(std::get<Shape>(scene.bodies[0].surface)).sides, (Vec3{0.04, 0.04, 0.2}));
    EXPECT_EQ(body.material, jelly);
    EXPECT_EQ(body.rotation.axis, (Vec3{0, 1, 0}));
    EXPECT_EQ(body.rotation.degrees, 30);
    EXPECT_EQ(body.translation, (Vec3{0, 0.5, 0}));
    EXPECT_EQ(body.velocity, (Vec3{0, 0, 1}));
    EXPECT_EQ(body.lattice, Lattice::bcc);
    EXPECT_EQ(body.spacing, 0.01);
    EXPECT_EQ(body.kernel.shape, KernelShape::wendland);
    EXPECT_EQ(body.kernel.support, 2.4);

    const Fix& fix = scene.fixes.at(0).fix;
    EXPECT_TRUE(fix.x && !fix.y && fix.z);
    ASSERT_EQ(fix.path.size(), 2u);
    EXPECT_EQ(fix.path[0].time, 0);
    EXPECT_EQ(fix.path[1].time, 0.5);
    EXPECT_EQ(fix.path[1].displacement, (Vec3{0, 0, 0.01}));
    EXPECT_EQ(scene.loads.at(0).load.force, (Vec3{0, -12, 0}));
    EXPECT_EQ(scene.loads.at(0).load.ramp, 0.1);
    EXPECT_EQ(std::get<Plane>(scene.colliders.at(0).shape).normal, (Vec3{0, 1, 0}));
    EXPECT_EQ(std::get<Plane>(scene.colliders.at(0).shape).friction, 0.25);
    EXPECT_EQ(scene.probes.at(0).name, "tip");
    EXPECT_EQ(scene.output.formats, (std::vector{OutputFormat::vtu, OutputFormat::ply}));
}

TEST(ReadScene, what_is_absent_has_the_contracts_default) {
    const Scene scene = read(least_scene);
    EXPECT_EQ(scene.title, "scene");
    EXPECT_EQ(scene.simulation.integrator, Integrator::implicit_euler);
    EXPECT_EQ(scene.simulation.duration, 2);
    EXPECT_EQ(scene.simulation.frame_rate, 60);
    EXPECT_EQ(scene.simulation.gravity, (Vec3{0, -9.81, 0}));
    EXPECT_EQ(scene.simulation.mass_damping, 0);
    EXPECT_EQ(scene.simulation.stiffness_damping, 0);
    const BodySettings& body = scene.bodies[0].settings;
    EXPECT_EQ(body.scale, 1);
    EXPECT_EQ(body.spacing, 0);
    EXPECT_EQ(body.count, 2000u);
    EXPECT_EQ(body.lattice, Lattice::cubic);
    EXPECT_EQ(body.quadrature, Quadrature::grid);
    EXPECT_EQ(body.kernel.shape, KernelShape::quartic_spline);
    EXPECT_EQ(scene.output.formats, (std::vector{OutputFormat::vtu}));
    EXPECT_TRUE(scene.fixes.empty() && scene.loads.empty() && scene.colliders.empty() && scene.probes.empty());
}

TEST(ReadScene, a_preset_stands_in_for_the_numbers_and_keys_of_its_own_override_it) {
    const Scene scene = read(with(least_scene, "preset = \"jelly\"", "preset = \"steel\"\nyoungs_modulus = 1e5"));
    const Material& steel = find_preset("steel").material;
    EXPECT_EQ(scene.materials[0].material.density, steel.density);
    EXPECT_EQ(scene.materials[0].material.poissons_ratio, steel.poissons_ratio);
    EXPECT_EQ(scene.materials[0].material.youngs_modulus, 1e5);
}

TEST(ReadScene, nodal_quadrature_brings_its_own_kernel_unless_the_scene_names_one) {
    const std::string nodal = std::string(least_scene) + "quadrature = \"nodes\"\n";
    EXPECT_EQ(read(nodal).bodies[0].settings.kernel.shape, KernelShape::poly6);
    EXPECT_EQ(read(nodal + "kernel = { support = 2.0 }").bodies[0].settings.kernel.shape, KernelShape::poly6);
    EXPECT_EQ(read(nodal + "kernel = { shape = \"wendland\" }").bodies[0].settings.kernel.shape, KernelShape::wendland);
}

TEST(ReadScene, regions_arrive_in_order_with_the_material_they_name) {
    const Scene scene = read(std::string(least_scene) + R"(
mean_dilatation = true
region = [
    { box = [[0, 0, 0], [1, 1, 1]], material = "bone" },
    { sphere = { center = [0, 1, 0], radius = 0.02 }, material = "jelly", transition = 0.01 },
    { mesh = "core.obj", part = "inner", scale = 2, translation = [0, 0, 1], material = "bone" },
]
[[material]]
name = "bone"
preset = "jelly"
youngs_modulus = 1e9
)");
    const BodySettings& settings = scene.bodies[0].settings;
    EXPECT_EQ(settings.mean_dilatation, true);
    ASSERT_EQ(settings.regions.size(), 3u);
    EXPECT_EQ(std::get<BoxRegion>(settings.regions[0].shape).upper, (Vec3{1, 1, 1}));
    EXPECT_EQ(settings.regions[0].material.youngs_modulus, 1e9);
    EXPECT_EQ(settings.regions[0].transition, 0);
    EXPECT_EQ(std::get<SphereRegion>(settings.regions[1].shape).center, (Vec3{0, 1, 0}));
    EXPECT_EQ(std::get<SphereRegion>(settings.regions[1].shape).radius, 0.02);
    EXPECT_EQ(settings.regions[1].material, settings.material);
    EXPECT_EQ(settings.regions[1].transition, 0.01);
    EXPECT_EQ(scene.bodies[0].regions[1].mesh.has_value(), false);
    EXPECT_EQ(scene.bodies[0].regions[2].mesh->part, "inner");
    EXPECT_EQ(scene.bodies[0].regions[2].scale, 2);
    EXPECT_EQ(scene.bodies[0].regions[2].material, 1u);
}

TEST(ReadScene, a_contact_surface_is_a_mesh_file_and_one_of_its_parts) {
    EXPECT_FALSE(read(std::string(least_scene)).bodies[0].contact_mesh.has_value());
    const Scene scene = read(std::string(least_scene) + "contact_mesh = \"hull.obj\"\ncontact_part = \"outer\"\n");
    ASSERT_TRUE(scene.bodies[0].contact_mesh.has_value());
    EXPECT_EQ(scene.bodies[0].contact_mesh->path, "hull.obj");
    EXPECT_EQ(scene.bodies[0].contact_mesh->part, "outer");
}

TEST(ReadScene, mean_dilatation_is_auto_unless_said) {
    EXPECT_EQ(read(least_scene).bodies[0].settings.mean_dilatation, std::nullopt);
    EXPECT_EQ(read(std::string(least_scene) + "mean_dilatation = \"auto\"").bodies[0].settings.mean_dilatation,
              std::nullopt);
    EXPECT_EQ(read(std::string(least_scene) + "mean_dilatation = false").bodies[0].settings.mean_dilatation, false);
}

TEST(ReadScene, unnamed_entries_are_called_by_their_index) {
    const Scene scene = read(with(least_scene, "name = \"ball\"", ""));
    EXPECT_EQ(scene.bodies[0].name, "body0");
}

TEST(ReadScene, an_integer_is_a_number) {
    EXPECT_EQ(read(with(good_scene, "duration   = 0.5", "duration   = 3")).simulation.duration, 3);
}

TEST(ReadScene, a_path_of_keyframes_moves_a_grip) {
    const Scene scene = read(with(good_scene, "displacement = [0.0, 0.0, 0.01]",
                                  "rotation = { axis = [0, 0, 4], center = [1, 0, 0] }\n"
                                  "path = [{ time = 0.1 }, { time = 0.2, displacement = [0, 1, 0], degrees = 90 }]"));
    const Fix& fix = scene.fixes[0].fix;
    ASSERT_EQ(fix.path.size(), 2u);
    EXPECT_EQ(fix.path[1].time, 0.2);
    EXPECT_EQ(fix.path[1].displacement, (Vec3{0, 1, 0}));
    EXPECT_EQ(fix.path[1].degrees, 90);
    EXPECT_EQ(fix.axis, (Vec3{0, 0, 1}));
    EXPECT_EQ(fix.center, (Vec3{1, 0, 0}));
}

TEST(ReadScene, an_empty_list_of_formats_stays_empty) {
    EXPECT_TRUE(read(with(good_scene, "[\"vtu\", \"ply\"]", "[]")).output.formats.empty());
}

TEST(Overrides, set_replaces_adds_and_reaches_into_lists_by_name_and_by_index) {
    const Scene scene = read(good_scene, {"simulation.duration=0.25", "material.jelly.youngs_modulus=3e5",
                                          "body.beam.sampling.spacing = 0.02", "collider.0.friction=0",
                                          "body.0.scale=2", "output.formats=[\"png\"]", "output.picture.width=640",
                                          "simulation.integrator=leap-frog", "title=a = b"});
    EXPECT_EQ(scene.simulation.duration, 0.25);
    EXPECT_EQ(scene.fixes[0].fix.path[1].time, 0.25);
    EXPECT_EQ(scene.bodies[0].settings.material.youngs_modulus, 3e5);
    EXPECT_EQ(scene.bodies[0].settings.spacing, 0.02);
    EXPECT_EQ(scene.bodies[0].settings.scale, 2);
    EXPECT_EQ(std::get<Plane>(scene.colliders[0].shape).friction, 0);
    EXPECT_EQ(scene.output.formats, (std::vector{OutputFormat::png}));
    EXPECT_EQ(scene.output.width, 640);
    EXPECT_EQ(scene.simulation.integrator, Integrator::leap_frog);
    EXPECT_EQ(scene.title, "a = b");
}

TEST(Overrides, one_of_two_alternatives_takes_the_others_place) {
    const Scene scene = read(with(good_scene, "[[fix]]",
                                  "[[body]]\nname = \"counted\"\nshape = { sphere = 0.1 }\nmaterial = \"jelly\"\n"
                                  "sampling = { count = 500 }\nkernel = { neighbors = 20 }\n\n[[fix]]"),
                             {"body.counted.sampling.spacing=0.01", "body.counted.kernel.support=2"});
    EXPECT_EQ(scene.bodies[1].settings.spacing, 0.01);
    EXPECT_EQ(scene.bodies[1].settings.kernel.support, 2);
    EXPECT_EQ(scene.bodies[1].settings.kernel.neighbors, 0);
}

TEST(Overrides, a_key_is_named_by_its_last_setting) {
    EXPECT_EQ(read(good_scene, {"simulation.duration=1", "simulation.duration=2"}).simulation.duration, 2);
}

TEST(Overrides, errors_name_the_argument) {
    TemporaryFolder folder;
    const auto path = folder.write("scene.toml", good_scene);
    const struct {
        const char *argument, *expected;
    } rows[] = {
        {"body.beam.sampling.spacing=-1",
         "field 'body.beam.sampling.spacing': found -1, expected a number above 0 [m]"},
        {"body.bean.scale=1", "did you mean 'beam'"},
        {"body.7.scale=1", "there is no '7'"},
        {"simulation.duratoin=1", "unknown key 'duratoin'; did you mean 'duration'"},
        {"simulation.duration=soon", "found a string \"soon\""},
        {"simulation.duration.x=1", "expected a table"},
        {"simulation.duration", "found no '='"},
        {"=1", "expected KEY=VALUE"},
        {"a b=1", "expected KEY=VALUE"},
        {"body.beam=1", "set key by key"},
        {"titel=1", "did you mean 'title'"},
        {"simulation.gravity=[0, nan, 0]", "field 'simulation.gravity[1]': found nan"},
    };
    for (const auto& row : rows) {
        const std::string message = refusal(path, {row.argument});
        EXPECT_NE(message.find(std::string("scene.toml: --set ") + row.argument + ": "), message.npos) << message;
        EXPECT_NE(message.find(row.expected), message.npos) << row.argument << " gave: " << message;
    }
}

}  // namespace
}  // namespace phyxel
