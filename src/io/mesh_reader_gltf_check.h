#pragma once

#include "io/mesh_reader_formats.h"

namespace phyxel {

/// Checks what assimp takes on trust: the GLB header and chunk lengths, the JSON, that every buffer is there in full,
/// every view lies in its buffer and every accessor in its view, and that nodes form a forest.
void check_gltf(const MeshFile& file);

}  // namespace phyxel
