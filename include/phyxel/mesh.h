#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "phyxel/vector.h"

namespace phyxel {

using Triangle = std::array<std::uint32_t, 3>;

/// A surface of triangles, as read from a file or made by the caller. Outward triangles are counter-clockwise seen from
/// outside. It need not be clean: `check_mesh` says what it is, and a body is made of any mesh whose inside is decided.
struct TriangleMesh {
    std::vector<Vec3>
        vertices;  ///< [vertices] positions; the unit is the caller's (`BodySettings::scale` makes it metres)
    std::vector<Triangle> triangles;  ///< [triangles] indices into `vertices`

    /// Named parts of the file (OBJ objects and groups, glTF nodes): triangles [begin, end) each, in file order. May be
    /// empty.
    struct Part {
        std::string name;
        std::size_t begin = 0, end = 0;
    };
    std::vector<Part> parts;

    /// Where the mesh came from, for messages; may be empty.
    std::string source;
};

/// Reads OBJ, PLY (ASCII and binary), STL (ASCII and binary), OFF, glTF and GLB, by the file's ending. Polygons become
/// triangles, all objects of the file one surface; `part` keeps only the part of that name.
/// Throws `Error` naming the file, the line or byte, and the remedy when the file is missing or malformed: an index out
/// of range, fewer records than announced, a coordinate that is not finite, no triangle, an unknown part.
TriangleMesh read_mesh(const std::filesystem::path& path, const std::string& part = {});

/// Closed shapes centred on the origin, outward, in metres.
TriangleMesh make_box(const Vec3& sides);
TriangleMesh make_sphere(double radius);                            ///< an icosphere whose volume is that of the sphere
TriangleMesh make_cylinder(double radius, double height);           ///< axis y
TriangleMesh make_torus(double major_radius, double minor_radius);  ///< axis y

/// What a mesh is, and what can be done with it.
struct MeshReport {
    std::size_t vertices = 0, triangles = 0;  ///< as read
    std::size_t duplicate_vertices = 0;       ///< welded: same position (seams of texture coordinates)
    std::size_t unused_vertices = 0;
    std::size_t degenerate_triangles = 0;   ///< dropped: no area, or a vertex twice
    std::size_t duplicate_triangles = 0;    ///< dropped
    std::size_t flipped_triangles = 0;      ///< reoriented so that neighbours agree
    bool inside_out = false;                ///< the whole surface was inward, and was flipped
    std::size_t boundary_edges = 0;         ///< edges of one triangle; 0 when closed
    std::size_t holes = 0;                  ///< closed loops of boundary edges
    std::size_t nonmanifold_edges = 0;      ///< edges of more than two triangles
    std::size_t nonmanifold_vertices = 0;   ///< vertices whose triangles do not form one fan
    std::size_t inconsistent_edges = 0;     ///< edges whose two triangles disagree about outside, after reorientation
    std::size_t self_intersections = 0;     ///< pairs of triangles that cross
    std::vector<Vec3> intersection_places;  ///< at most 16 of them
    std::vector<Vec3> hole_places;          ///< centres of at most 16 holes, largest first
    std::size_t components = 0;             ///< connected parts of the surface
    long genus = 0;                         ///< handles, summed over components; only when closed and manifold
    double area = 0;
    double signed_volume = 0;  ///< by the divergence theorem
    double volume = 0;         ///< of the region whose winding number is above 1/2
    Vec3 lower, upper;         ///< bounding box

    bool closed() const { return boundary_edges == 0; }
    bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
    bool oriented() const { return inconsistent_edges == 0; }

    bool can_be_simulated = false;
    std::string refusal;               ///< why not, where, and what to do; empty when it can
    std::vector<std::string> repairs;  ///< what was, or would be, mended: one sentence each
};

/// Examines a mesh, and mends it as far as its winding number decides (welds, drops, flips).
MeshReport check_mesh(const TriangleMesh& mesh);

}  // namespace phyxel
