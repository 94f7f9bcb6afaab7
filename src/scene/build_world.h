#pragma once

#include "phyxel/world.h"
#include "scene/scene.h"

namespace phyxel {

/// A scene's world, and what its entries are called in there.
struct BuiltScene {
    World world;
    std::vector<BodyId> bodies;       ///< [Scene::bodies]
    std::vector<std::size_t> fixes;   ///< [Scene::fixes]
    std::vector<std::size_t> probes;  ///< [Scene::probes]
};

/// Reads the meshes of a scene and makes its world. Throws `Error` that points at the scene's line for whatever cannot
/// be: a missing or broken mesh, too few or too many nodes, an empty selection, a probe outside its body.
/// `threads` as in `WorldSettings`.
BuiltScene build_world(const Scene& scene, int threads = 0);

}  // namespace phyxel
