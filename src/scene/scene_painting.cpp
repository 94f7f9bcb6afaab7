#include "scene/scene_painting.h"

#include <algorithm>

namespace phyxel {
namespace {

/// Body colours, sRGB, in order; told apart by eyes of all kinds (after Okabe and Ito 2008, softened).
constexpr Vec3f palette[] = {
    {0.93f, 0.45f, 0.30f}, {0.34f, 0.64f, 0.85f}, {0.25f, 0.68f, 0.52f}, {0.92f, 0.72f, 0.28f}, {0.76f, 0.52f, 0.70f}};

void include(Vec3& lower, Vec3& upper, const Vec3& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], point[axis]);
        upper[axis] = std::max(upper[axis], point[axis]);
    }
}

/// The value that 99 % of a field stay below: a single vertex must not take the colours from all others.
double high_value(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

/// A camera that sees all bodies where they start, and the floor below them.
Camera default_camera(const Scene& scene, const BuiltScene& built) {
    Vec3 lower{1e300, 1e300, 1e300}, upper = -lower;
    for (const BodyId body : built.bodies)
        for (const Vec3f& vertex : built.world.surface(body).positions())
            include(lower, upper, vector_cast<double>(vertex));
    const Vec3 corners[] = {lower, upper};
    for (const SceneCollider& collider : scene.colliders)
        if (const auto* plane = std::get_if<Plane>(&collider.shape)) {
            const Vec3 normal = normalized(plane->normal);
            for (const Vec3& corner : corners)
                include(lower, upper, corner - dot(corner - plane->point, normal) * normal);
        }
    const Vec3 up = scene.simulation.gravity == Vec3{} ? Vec3{0, 1, 0} : -normalized(scene.simulation.gravity);
    return fit_camera(lower, upper, static_cast<double>(scene.output.width) / scene.output.height, up);
}

Camera camera_of(const Scene& scene, const BuiltScene& built) {
    Camera camera = default_camera(scene, built);
    if (const std::optional<SceneCamera>& asked = scene.output.camera) {
        camera.eye = asked->position;
        camera.target = asked->target;
        camera.field_of_view = asked->field_of_view;
    }
    return camera;
}

}  // namespace

ScenePainting::ScenePainting(const Scene& scene, const BuiltScene& built)
    : scene_(&scene),
      built_(&built),
      renderer_(scene.output.width, scene.output.height),
      camera_(camera_of(scene, built)) {
    for (const BodyId body : built.bodies) {
        const auto positions = built.world.surface(body).positions();
        rest_.emplace_back(positions.begin(), positions.end());
    }
}

std::vector<float> ScenePainting::field(std::size_t body) const {
    if (scene_->output.color_by == ColorBy::none) return {};
    if (scene_->output.color_by == ColorBy::von_mises) return built_->world.surface_von_mises(built_->bodies[body]);
    const auto positions = built_->world.surface(built_->bodies[body]).positions();
    std::vector<float> lengths(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) lengths[i] = norm(positions[i] - rest_[body][i]);
    return lengths;
}

Picture ScenePainting::draw() {
    RenderScene picture;
    picture.camera = camera_;

    // Bodies and their fields; the scale only ever grows, so that colours of a film can be compared
    std::vector<std::vector<float>> fields(built_->bodies.size());
    for (std::size_t i = 0; i < built_->bodies.size(); ++i) {
        const Surface& surface = built_->world.surface(built_->bodies[i]);
        fields[i] = field(i);
        largest_ = std::max(largest_, high_value(fields[i]));
        picture.meshes.push_back(
            {surface.positions(), surface.normals(), surface.triangles(), palette[i % std::size(palette)], fields[i]});
    }
    if (scene_->output.color_by != ColorBy::none) {
        const bool stress = scene_->output.color_by == ColorBy::von_mises;
        picture.scale = ColorScale{0, largest_ > 0 ? largest_ : 1, stress ? "von Mises stress" : "displacement",
                                   stress ? "Pa" : "m"};
    }

    for (const SceneCollider& collider : scene_->colliders) {
        if (const auto* plane = std::get_if<Plane>(&collider.shape)) picture.planes.push_back(*plane);
        if (const auto* sphere = std::get_if<Sphere>(&collider.shape)) picture.spheres.push_back(*sphere);
        if (const auto* box = std::get_if<Box>(&collider.shape)) picture.boxes.push_back(*box);
    }
    return renderer_.draw(picture);
}

}  // namespace phyxel
