#include <bit>
#include <cstring>

#include "io/mesh_reader_text.h"

/// STL, text and binary. Every triangle brings its own three vertices; the mesh check welds them.

namespace phyxel {

namespace {

constexpr std::size_t header_size = 84;    // 80 bytes of anything, then the number of triangles
constexpr std::size_t triangle_size = 50;  // a normal and three vertices as floats, and two bytes

bool starts_with_solid(const std::string& bytes) {
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string::npos && bytes.compare(first, 5, "solid") == 0;
}

/// Binary files may start with "solid" as well: their length, or a zero byte, gives them away.
bool is_text(const std::string& bytes) {
    if (!starts_with_solid(bytes)) return false;
    if (bytes.size() >= header_size && bytes.size() == header_size + triangle_size * std::size_t{u32_at(bytes, 80)})
        return false;
    return bytes.find('\0') == std::string::npos;
}

void end_triangle(PolygonMesh& mesh, std::size_t place) {
    for (std::int64_t k = 3; k > 0; --k) mesh.corners.push_back(static_cast<std::int64_t>(mesh.vertices.size()) - k);
    mesh.end_polygon(place);
}

PolygonMesh read_binary(const MeshFile& file) {
    const std::string& bytes = file.bytes;
    if (bytes.size() < header_size)
        file.fail("byte " + std::to_string(bytes.size()),
                  "the file ends within the 84 bytes of a binary STL's header: it is truncated, or no STL");
    const std::size_t count = u32_at(bytes, 80);
    if (count > (bytes.size() - header_size) / triangle_size)
        file.fail("byte 80", "announces " + std::to_string(count) + " triangles, but the file has room for " +
                                 std::to_string((bytes.size() - header_size) / triangle_size) +
                                 ": it is truncated, or no STL; export it again");
    PolygonMesh mesh;
    mesh.place_unit = "byte";
    mesh.vertices.reserve(3 * count);
    for (std::size_t t = 0; t < count; ++t) {
        const std::size_t record = header_size + triangle_size * t;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            Vec3 x;
            for (std::size_t axis = 0; axis < 3; ++axis)
                x[axis] = std::bit_cast<float>(u32_at(bytes, record + 12 + 12 * corner + 4 * axis));
            if (!is_finite(x))
                file.fail("byte " + std::to_string(record + 12 + 12 * corner),
                          "a coordinate of triangle " + std::to_string(t + 1) +
                              " is not a finite number: mend it in the program that wrote the file");
            mesh.vertices.push_back(x);
        }
        end_triangle(mesh, record);
    }
    return mesh;
}

PolygonMesh read_text(const MeshFile& file) {
    PolygonMesh mesh;
    TextScanner in(file);
    in.no_comments();
    std::string solid;
    std::size_t solid_begin = 0, facet_line = 1, facet_begin = 0;
    bool in_solid = false;
    for (std::string_view token = in.token(); !token.empty(); token = in.token()) {
        if (token == "solid") {
            solid = in.rest_of_line();
            solid_begin = mesh.polygons();
            in_solid = true;
        } else if (token == "facet") {
            facet_line = in.line();
            facet_begin = mesh.vertices.size();
        } else if (token == "normal") {
            for (int axis = 0; axis < 3; ++axis) in.token();  // follows from the vertices, and is often wrong
        } else if (token == "vertex") {
            const double x = in.number_on_line("a vertex's x");
            const double y = in.number_on_line("a vertex's y");
            mesh.vertices.push_back({x, y, in.number_on_line("a vertex's z")});
        } else if (token == "endfacet") {
            if (mesh.vertices.size() != facet_begin + 3)
                in.fail("a facet of " + std::to_string(mesh.vertices.size() - facet_begin) +
                        " vertices, where 3 are needed: the file is damaged, export it again");
            end_triangle(mesh, facet_line);
            facet_begin = mesh.vertices.size();
        } else if (token == "endsolid") {
            in.rest_of_line();
            mesh.end_part(solid, solid_begin);
            in_solid = false;
        } else if (token != "outer" && token != "loop" && token != "endloop") {
            in.fail("expected facet, vertex or endsolid, but found " + in_quotes(token) +
                    ": the file is damaged, or no STL");
        }
    }
    if (in_solid) in.fail("the file ends before endsolid: it is truncated, export it again");
    return mesh;
}

}  // namespace

PolygonMesh read_stl(const MeshFile& file) { return is_text(file.bytes) ? read_text(file) : read_binary(file); }

}  // namespace phyxel
