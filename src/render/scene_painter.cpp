#include "render/scene_painter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/color_map.h"
#include "render/legend.h"
#include "render/shaders.h"
#include "render/unit_shapes.h"

namespace phyxel {
namespace {

constexpr int samples_per_pixel = 4;
constexpr int shadow_map_size = 1024, contact_size = 128;

enum TextureUnit { shadow_unit, contact_unit, color_unit, overlay_unit };

/// sRGB to linear light (IEC 61966-2-1).
float linear_light(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }
Vec3f linear_light(const Vec3f& c) { return {linear_light(c.x), linear_light(c.y), linear_light(c.z)}; }

std::uint8_t to_byte(float v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255)); }

Mat4f placed(const Sphere& s) { return affine(s.radius * Mat3::identity(), s.center); }
Mat4f placed(const Box& b) {
    const Mat3 R = rotation_about(normalized(b.rotation.axis), b.rotation.degrees * (std::numbers::pi / 180));
    return affine(R * Mat3::diagonal(b.size), b.center);
}

/// The largest of 1, 2 and 5 times a power of ten not above `length`.
double round_length(double length) {
    const double power = std::pow(10.0, std::floor(std::log10(length)));
    return power * (length / power >= 5 ? 5 : length / power >= 2 ? 2 : 1);
}

/// The table of colours, as a texture.
GlName make_color_texture() {
    std::vector<std::uint8_t> table;
    for (int i = 0; i < 256; ++i)
        for (const Vec3f c = color_map(i / 255.0); float v : {c.x, c.y, c.z}) table.push_back(to_byte(v));
    return make_texture(GL_SRGB8, 256, 1, GL_RGB, GL_UNSIGNED_BYTE, table.data());
}

void bind_texture(TextureUnit unit, const GlName& texture) {
    glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
    glBindTexture(GL_TEXTURE_2D, texture);
}

void upload_shape(GlMesh& mesh, const ShapeMesh& shape) {
    mesh.upload(shape.positions, shape.normals, {}, shape.triangles);
}

}  // namespace

ScenePainter::ScenePainter()
    : backdrop_(shaders::square_vertex(), shaders::backdrop_fragment()),
      surface_(shaders::surface_vertex(), shaders::surface_fragment()),
      floor_(shaders::surface_vertex(), shaders::floor_fragment()),
      contact_(shaders::square_vertex(), shaders::contact_fragment()),
      overlay_(shaders::square_vertex(), shaders::overlay_fragment()),
      shadow_map_(shadow_map_size, true),
      floor_heights_(contact_size, false),
      contact_texture_(make_texture(GL_R8, contact_size, contact_size, GL_RED, GL_UNSIGNED_BYTE)),
      contact_framebuffer_(make_framebuffer()),
      color_texture_(make_color_texture()) {
    upload_shape(square_, unit_square());
    upload_shape(sphere_, unit_sphere());
    upload_shape(cube_, unit_cube());
    glBindFramebuffer(GL_FRAMEBUFFER, contact_framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, contact_texture_, 0);
}

void ScenePainter::draw(const RenderScene& scene, int width, int height) {
    resize(width, height);
    upload(scene);
    const Bounds bounds = bounds_of(scene);

    draw_shadow_map(scene, bounds);
    draw_contact_shade(scene, bounds);

    glBindFramebuffer(GL_FRAMEBUFFER, sampled_.framebuffer);
    glViewport(0, 0, width_, height_);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_backdrop();
    glEnable(GL_DEPTH_TEST);
    set_lighting(surface_, scene, bounds);
    draw_surfaces(scene);
    set_lighting(floor_, scene, bounds);
    draw_planes(scene);
    glDisable(GL_DEPTH_TEST);

    glBindFramebuffer(GL_READ_FRAMEBUFFER, sampled_.framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, finished_.framebuffer);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    if (scene.scale) draw_overlay(scene);
}

// --- framebuffers and uploads

ScenePainter::Target ScenePainter::make_target(int width, int height, int samples) {
    Target target{make_renderbuffer(GL_SRGB8_ALPHA8, width, height, samples),
                  make_renderbuffer(GL_DEPTH_COMPONENT24, width, height, samples), make_framebuffer()};
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
    return target;
}

void ScenePainter::resize(int width, int height) {
    if (width == width_ && height == height_) return;
    sampled_ = make_target(width, height, samples_per_pixel);
    finished_ = make_target(width, height, 0);
    width_ = width, height_ = height;
}

void ScenePainter::upload(const RenderScene& scene) {
    while (meshes_.size() < scene.meshes.size()) meshes_.emplace_back();
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const RenderMesh& mesh = scene.meshes[m];
        meshes_[m].upload(mesh.positions, mesh.normals, mesh.field, mesh.triangles);
    }
}

ScenePainter::Bounds ScenePainter::bounds_of(const RenderScene& scene) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 lower{infinity, infinity, infinity}, upper = -lower;
    const auto add = [&](const Vec3& center, double radius) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], center[axis] - radius);
            upper[axis] = std::max(upper[axis], center[axis] + radius);
        }
    };
    for (const RenderMesh& mesh : scene.meshes)
        for (const Vec3f& x : mesh.positions) add(vector_cast<double>(x), 0);
    for (const Sphere& sphere : scene.spheres) add(sphere.center, sphere.radius);
    for (const Box& box : scene.boxes) add(box.center, norm(box.size) / 2);
    const Vec3 center = 0.5 * (lower + upper);
    const double radius = norm(upper - lower) / 2;
    return is_finite(center) && radius > 0 ? Bounds{center, radius} : Bounds{scene.camera.target, 1};
}

// --- passes

void ScenePainter::draw_casters(const RenderScene& scene, const Shader& shader) const {
    shader.set("to_world", affine(Mat3::identity(), {}));
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) meshes_[m].draw();
    for (const Sphere& sphere : scene.spheres) {
        shader.set("to_world", placed(sphere));
        sphere_.draw();
    }
    for (const Box& box : scene.boxes) {
        shader.set("to_world", placed(box));
        cube_.draw();
    }
}

void ScenePainter::draw_shadow_map(const RenderScene& scene, const Bounds& bounds) {
    const HorizontalFrame frame = horizontal_frame(scene.camera.up);
    light_ = direction_at(frame, -35, 52);
    const double reach = 1.02 * bounds.radius;
    shadow_map_.draw(bounds.center + reach * light_, light_, frame.front, reach, 2 * reach,
                     [&](const Shader& shader) { draw_casters(scene, shader); });
}

void ScenePainter::draw_contact_shade(const RenderScene& scene, const Bounds& bounds) {
    contact_half_width_ = 0;
    if (scene.planes.empty()) return;
    const Plane& floor = scene.planes.front();
    const HorizontalFrame frame = horizontal_frame(floor.normal);
    contact_middle_ = bounds.center - dot(bounds.center - floor.point, frame.up) * frame.up;
    contact_half_width_ = 1.6 * bounds.radius;

    // Looking up from a little below the floor.
    const double below = 0.1 * bounds.radius, depth = 2 * bounds.radius;
    floor_heights_.draw(contact_middle_ - below * frame.up, -frame.up, frame.front, contact_half_width_, depth,
                        [&](const Shader& shader) { draw_casters(scene, shader); });

    glBindFramebuffer(GL_FRAMEBUFFER, contact_framebuffer_);
    glDisable(GL_DEPTH_TEST);
    floor_heights_.bind(contact_unit);
    contact_.use();
    contact_.set("heights", contact_unit);
    contact_.set("texel", static_cast<float>(2 * contact_half_width_ / contact_size));
    contact_.set("depth", static_cast<float>(depth));
    contact_.set("below", static_cast<float>(below));
    contact_.set("center", 0.0f, 0.0f);
    contact_.set("half_size", 1.0f, 1.0f);
    square_.draw();
}

void ScenePainter::set_lighting(const Shader& shader, const RenderScene& scene, const Bounds& bounds) const {
    // The near plane keeps most of the depth's precision around what is looked at.
    const Camera& camera = scene.camera;
    const double distance = camera.distance(), aspect = static_cast<double>(width_) / height_;
    const double far = distance + 40 * camera.half_height() + 2 * bounds.radius;
    shader.use();
    shader.set("to_clip", perspective_matrix(camera.tangent(), aspect, 0.02 * distance, far) *
                              view_matrix(camera.eye, camera.backward(), camera.up));
    shader.set("to_world", affine(Mat3::identity(), {}));
    shader.set("eye", camera.eye);
    shader.set("light", light_);
    shader.set("up", normalized(camera.up));
    shader.set("shadow_map", shadow_unit);
    shader.set("to_shadow", shadow_map_.to_clip());
    shader.set("shadow_step", 2.2f / shadow_map_size);
    shader.set("shadow_offset", static_cast<float>(12 * bounds.radius / shadow_map_size));
    shader.set("picture_size", static_cast<float>(width_), static_cast<float>(height_));
    shadow_map_.bind(shadow_unit);
}

void ScenePainter::draw_backdrop() const {
    backdrop_.use();
    backdrop_.set("picture_size", static_cast<float>(width_), static_cast<float>(height_));
    backdrop_.set("center", 0.0f, 0.0f);
    backdrop_.set("half_size", 1.0f, 1.0f);
    square_.draw();
}

void ScenePainter::draw_surfaces(const RenderScene& scene) const {
    const ColorScale scale = scene.scale.value_or(ColorScale{});
    const double range = scale.upper - scale.lower;
    bind_texture(color_unit, color_texture_);
    surface_.set("colors", color_unit);
    surface_.set("field_scale", static_cast<float>(scale.lower), static_cast<float>(range > 0 ? 1 / range : 0));
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        surface_.set("by_field", scene.meshes[m].field.empty() ? 0 : 1);
        surface_.set("albedo", linear_light(scene.meshes[m].color));
        meshes_[m].draw();
    }

    // Things that are not bodies are grey.
    surface_.set("by_field", 0);
    surface_.set("albedo", linear_light({0.62f, 0.65f, 0.69f}));
    for (const Sphere& sphere : scene.spheres) {
        surface_.set("to_world", placed(sphere));
        sphere_.draw();
    }
    for (const Box& box : scene.boxes) {
        surface_.set("to_world", placed(box));
        cube_.draw();
    }
}

void ScenePainter::draw_planes(const RenderScene& scene) const {
    bind_texture(contact_unit, contact_texture_);
    floor_.set("contact", contact_unit);
    floor_.set("contact_middle", contact_middle_);
    const double seen = scene.camera.half_height();
    floor_.set("tile", static_cast<float>(round_length(0.5 * seen)));
    floor_.set("clear_radius", static_cast<float>(2 * seen));
    floor_.set("fade_radius", static_cast<float>(11 * seen));
    for (const Plane& plane : scene.planes) {
        const HorizontalFrame frame = horizontal_frame(plane.normal);
        if (dot(scene.camera.eye - plane.point, frame.up) <= 0) continue;
        const Vec3 middle = scene.camera.target - dot(scene.camera.target - plane.point, frame.up) * frame.up;
        const bool is_floor = &plane == &scene.planes.front();
        floor_.set("axis_u", frame.side);
        floor_.set("axis_v", frame.front);
        floor_.set("middle", middle);
        floor_.set("contact_half_width", static_cast<float>(is_floor ? contact_half_width_ : 0));
        floor_.set("to_world", affine(12 * seen * Mat3::from_columns(frame.side, frame.front, frame.up), middle));
        square_.draw();
    }
}

void ScenePainter::draw_overlay(const RenderScene& scene) {
    const Canvas canvas = draw_legend(*scene.scale, height_);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(canvas.pixels().size() * 4);
    for (const Color& c : canvas.pixels())
        for (float v : {c.r, c.g, c.b, c.a}) bytes.push_back(to_byte(v));
    glActiveTexture(GL_TEXTURE0 + overlay_unit);
    const GlName image =
        make_texture(GL_RGBA8, canvas.width(), canvas.height(), GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());

    // Pixel by pixel, at the right edge, in the middle of the height.
    const int left = width_ - canvas.width() - height_ / 40, bottom = (height_ - canvas.height()) / 2;
    glViewport(left, bottom, canvas.width(), canvas.height());
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    overlay_.use();
    overlay_.set("image", overlay_unit);
    overlay_.set("center", 0.0f, 0.0f);
    overlay_.set("half_size", 1.0f, 1.0f);
    square_.draw();
    glDisable(GL_BLEND);
}

}  // namespace phyxel
