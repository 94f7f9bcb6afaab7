#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "phyxel/mesh.h"

namespace phyxel {

/// A mesh file in memory.
struct MeshFile {
    std::filesystem::path path;
    std::string name;   ///< as in messages
    std::string bytes;  ///< the whole content

    /// Throws `Error`: "NAME, line 12: MESSAGE". `place` may be empty.
    [[noreturn]] void fail(const std::string& place, const std::string& message) const;
};

/// What every format's reader delivers: polygons as they stand in the file, not yet checked or cut into triangles.
struct PolygonMesh {
    std::vector<Vec3> vertices;             ///< [vertices] finite positions
    std::vector<std::int64_t> corners;      ///< [corners] vertex of each corner, counted from 0
    std::vector<std::size_t> ends;          ///< [polygons] one past the polygon's last corner
    std::vector<std::size_t> places;        ///< [polygons] where it stands in the file, in units of `place_unit`
    std::vector<TriangleMesh::Part> parts;  ///< ranges of polygons
    std::string place_unit = "line";
    std::int64_t first_index = 0;  ///< what the format calls its first vertex

    std::size_t polygons() const { return ends.size(); }
    /// Ends the polygon whose corners were pushed.
    void end_polygon(std::size_t place);
    /// Ends the part that began at polygon `begin`; parts without polygons are dropped.
    void end_part(const std::string& part_name, std::size_t begin);
};

PolygonMesh read_obj(const MeshFile& file);
PolygonMesh read_ply(const MeshFile& file);
PolygonMesh read_stl(const MeshFile& file);
PolygonMesh read_off(const MeshFile& file);
PolygonMesh read_gltf(const MeshFile& file);

/// Checks every corner's index and cuts polygons into triangles.
TriangleMesh triangulate(const PolygonMesh& polygons, const MeshFile& file);

/// Cuts one simple polygon, convex or not, into corners.size() - 2 triangles of corner numbers, by ear clipping in the
/// plane that suits it best. A polygon that crosses itself gets as many triangles, in some order.
std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(const std::vector<Vec3>& corners);

/// The little-endian value of a binary file at `offset`; floats come as their bits.
inline std::uint32_t u32_at(const std::string& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + k]);
    return value;
}

/// `token` for a message: in quotes, shortened, without control characters.
std::string in_quotes(std::string_view token);

}  // namespace phyxel
