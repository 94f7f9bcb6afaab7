#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// A scalar at each vertex of a surface.
struct VertexScalar {
    std::string name;               ///< a word: letters, digits, underscores
    std::span<const float> values;  ///< [vertices]
};

/// A surface as it goes into a file. Only positions and triangles must be there.
struct SurfaceView {
    std::span<const Vec3f> positions;            ///< [vertices]
    std::span<const Triangle> triangles;         ///< [triangles]
    std::span<const Vec3f> normals = {};         ///< [vertices] or empty
    std::span<const VertexScalar> scalars = {};  ///< written to PLY only
};

/// Binary little-endian PLY, atomically: `property float x, y, z`, then `nx, ny, nz` if there are normals, then one
/// `property float` a scalar; faces as `property list uchar int vertex_indices`; no comments.
/// A value that is not finite, and every error of the system, is an `Error`.
void write_ply(const std::filesystem::path& path, const SurfaceView& surface);

/// Wavefront OBJ, atomically, with the digits that read back as the same numbers.
void write_obj(const std::filesystem::path& path, const SurfaceView& surface);

}  // namespace phyxel
