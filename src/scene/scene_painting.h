#pragma once

#include <vector>

#include "render/renderer.h"
#include "scene/build_world.h"

namespace phyxel {

/// Draws a world as its scene asks for: camera, size, colours.
class ScenePainting {
public:
    /// To be made while the world is at rest: the camera is fitted to it, and displacements are measured from it.
    ScenePainting(const Scene& scene, const BuiltScene& built);

    Picture draw();

private:
    std::vector<float> field(std::size_t body) const;

    const Scene* scene_;
    const BuiltScene* built_;
    Renderer renderer_;
    Camera camera_;
    std::vector<std::vector<Vec3f>> rest_;  // [bodies][vertices]
    double largest_ = 0;                    // of the field, so far: the colours' upper end
};

}  // namespace phyxel
