#pragma once

#include <vector>

#include "render/depth_map.h"
#include "render/gl_objects.h"
#include "render/render_scene.h"

namespace phyxel {

/// Draws scenes with the OpenGL 3.3 context that is current while it is made, used and destroyed: without a window for
/// pictures, in one for the viewer. A picture is made in passes: shadow map from the key light; what the floor does not
/// see of the sky; backdrop, surfaces and floor, four samples a pixel; legend.
class ScenePainter {
public:
    ScenePainter();

    /// Draws into the painter's own framebuffer.
    void draw(const RenderScene& scene, int width, int height);
    /// The finished picture, to be read or copied from, as wide and high as last drawn.
    GLuint framebuffer() const { return finished_.framebuffer; }

private:
    struct Target {
        GlName color, depth, framebuffer;
    };
    /// A sphere around all that throws a shadow.
    struct Bounds {
        Vec3 center;
        double radius = 1;
    };

    void resize(int width, int height);
    static Target make_target(int width, int height, int samples);
    void upload(const RenderScene& scene);
    static Bounds bounds_of(const RenderScene& scene);
    void draw_casters(const RenderScene& scene, const Shader& shader) const;
    void draw_shadow_map(const RenderScene& scene, const Bounds& bounds);
    void draw_contact_shade(const RenderScene& scene, const Bounds& bounds);
    void set_lighting(const Shader& shader, const RenderScene& scene, const Bounds& bounds) const;
    void draw_backdrop() const;
    void draw_surfaces(const RenderScene& scene) const;
    void draw_planes(const RenderScene& scene) const;
    void draw_overlay(const RenderScene& scene);

    int width_ = 0, height_ = 0;
    Target sampled_, finished_;
    Shader backdrop_, surface_, floor_, contact_, overlay_;
    GlMesh square_, sphere_, cube_;
    std::vector<GlMesh> meshes_;
    DepthMap shadow_map_, floor_heights_;
    GlName contact_texture_, contact_framebuffer_, color_texture_;
    Vec3 light_{0, 1, 0};            ///< towards the key light
    Vec3 contact_middle_;            ///< [m] on the floor
    double contact_half_width_ = 0;  ///< [m]; 0: no floor
};

}  // namespace phyxel
