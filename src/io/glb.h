#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// One body of an animation: its surface keeps its triangles while its vertices move.
struct GlbMesh {
    std::string name;
    std::span<const Triangle> triangles;
    Vec3f color = {0.8f, 0.8f, 0.8f};  ///< base colour, linear RGB in [0, 1]
};

/// Where the vertices of one body are in one frame.
struct GlbPose {
    std::span<const Vec3f> positions;  ///< [vertices] [m]
    std::span<const Vec3f> normals;    ///< [vertices] unit vectors
};

/// Writes an animation as binary glTF 2.0 (.glb): the first frame is the mesh, each later one a morph target that holds
/// the differences to it, and an animation of the targets' weights goes linearly from frame to frame.
///
/// The format puts its index before its data, so that all frames are held until `finish`: 24 bytes a vertex and frame.
/// The weights take 4 bytes times the square of the number of frames. A file cannot exceed 4 GiB; and programs that
/// show it keep every target in memory, some no more than 2048 of them: for long runs write fewer frames.
class GlbWriter {
public:
    GlbWriter(std::filesystem::path path, std::span<const GlbMesh> meshes);

    /// Adds the frame at `time` [s], one pose a mesh; a frame that is not later than the last is left out, as when a
    /// run fails before its next. `Error` when a value is not finite, a body has another number of vertices than
    /// before, or the file would exceed 4 GiB.
    void add_frame(double time, std::span<const GlbPose> poses);

    std::size_t frames() const { return times_.size(); }

    /// Writes the file, atomically; there must be a frame.
    void finish() const;

private:
    /// The first frame, or the differences of a later one to it.
    struct Shape {
        std::vector<Vec3f> vectors;    // [positions, normals][vertices]
        std::array<Vec3f, 2> extents;  // least and largest coordinates of the positions
    };
    struct Body {
        std::string name;
        Vec3f color;
        std::vector<Triangle> triangles;
        std::size_t vertices = 0;
        std::vector<Shape> shapes;  // [frames]
    };

    void add_pose(Body& body, const GlbPose& pose);
    std::vector<float> weights() const;
    std::uint64_t size_bound(std::size_t frames) const;
    std::string index(std::size_t weights) const;

    std::filesystem::path path_;
    std::vector<Body> bodies_;
    std::vector<float> times_;
};

}  // namespace phyxel
