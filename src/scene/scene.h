#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "phyxel/body.h"
#include "phyxel/material.h"
#include "phyxel/world.h"
#include "scene/scene_text.h"

namespace phyxel {

/// What a scene file says: plain values, every default filled in, every reference resolved to an index. The keys and
/// their meaning are in docs/scene.md.

struct SceneSimulation {
    Integrator integrator = Integrator::implicit_euler;
    std::optional<double> time_step{};  ///< [s]; none: from the stability bound (explicit integrators only)
    double duration = 2;                ///< [s]
    double frame_rate = 60;             ///< [1/s] of written output
    Vec3 gravity{0, -9.81, 0};          ///< [m/s^2]
    double mass_damping = 0;            ///< [1/s]
    double stiffness_damping = 0;       ///< [s]
    SolverSettings solver{};
};

struct SceneMaterial {
    std::string name;
    Material material;
};

/// Closed shapes that need no mesh file, centred on the origin; lengths in the body's unit.
struct BoxShape {
    Vec3 sides;
};
struct SphereShape {
    double radius = 0;
};
struct CylinderShape {
    double radius = 0, height = 0;
};
struct TorusShape {
    double major = 0, minor = 0;
};
using Shape = std::variant<BoxShape, SphereShape, CylinderShape, TorusShape>;

/// A mesh file, found from the scene's folder, and optionally one of its parts.
struct MeshFile {
    std::filesystem::path path;
    std::string part;
};

/// What a region's settings do not hold yet: its mesh, and how that is placed in rest space.
struct SceneRegion {
    std::size_t material = 0;        ///< index into `Scene::materials`, also in the settings
    std::optional<MeshFile> mesh{};  ///< none: a box or a sphere
    double scale = 1;
    AxisAngle rotation{};
    Vec3 translation{};
    Place place;
};

struct SceneBody {
    std::string name;
    std::variant<MeshFile, Shape> surface;
    std::size_t material = 0;          ///< index into `Scene::materials`, also in `settings`
    std::vector<SceneRegion> regions;  ///< of `settings.regions`
    std::optional<MeshFile> contact_mesh{};
    BodySettings settings;
    Place place, surface_place, sampling_place, contact_place;
};

struct SceneFix {
    std::string name;
    std::size_t body = 0;
    Fix fix;
    Place place;
};

struct SceneLoad {
    std::string name;
    std::size_t body = 0;
    Load load;
    Place place;
};

struct SceneCollider {
    std::string name;
    std::variant<Plane, Sphere, Box> shape;
    Place place;
};

struct SceneProbe {
    std::string name;
    std::size_t body = 0;
    Vec3 point;  ///< rest space [m]
    Place place;
};

enum class OutputFormat { vtu, ply, obj, png, mp4, glb };
enum class ColorBy { none, von_mises, displacement };

/// Where the pictures are taken from.
struct SceneCamera {
    Vec3 position, target;
    double field_of_view = 28;  ///< vertical [degrees]
};

struct SceneOutput {
    std::vector<OutputFormat> formats{OutputFormat::vtu};
    int width = 1280, height = 720;  ///< of pictures, pixels
    ColorBy color_by = ColorBy::none;
    std::optional<SceneCamera> camera;       ///< none: one that sees the whole run's start and the floor below
    std::optional<double> checkpoint_every;  ///< [s] of simulated time; none: every frame, and none without formats

    bool writes(OutputFormat format) const;
};

struct Scene {
    std::shared_ptr<const SceneText> text;  ///< what messages quote
    std::string name;                       ///< the file's, without its ending
    std::string title;
    SceneSimulation simulation;
    std::vector<SceneMaterial> materials;
    std::vector<SceneBody> bodies;
    std::vector<SceneFix> fixes;
    std::vector<SceneLoad> loads;
    std::vector<SceneCollider> colliders;
    std::vector<SceneProbe> probes;
    SceneOutput output;
};

/// Reads a scene file and applies `overrides`, "KEY=VALUE" each, in order. Throws `Error` naming file, line, column,
/// field, what was found, what was expected and how to mend it. Opens no mesh and creates nothing.
Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

}  // namespace phyxel
