#include "io/mesh_reader_text.h"

/// Wavefront OBJ: `v` positions (what follows x y z, a weight or a colour, is skipped), `f` faces of any length with
/// indices `v`, `v/vt`, `v//vn`, `v/vt/vn`, from 1 or, negative, back from the last vertex; `o` and `g` name parts.
/// Everything else (texture, normals, materials, lines, smoothing) does not shape the surface and is skipped.

namespace phyxel {

namespace {

/// A part that is open while faces come in.
struct OpenPart {
    std::string name;
    std::size_t begin = 0;

    void reopen(PolygonMesh& mesh, std::string_view next_name) {
        if (!name.empty()) mesh.end_part(name, begin);
        name = next_name;
        begin = mesh.polygons();
    }
};

void read_face(TextScanner& in, PolygonMesh& mesh) {
    const std::size_t line = in.line();
    for (std::string_view corner = in.token_on_line(); !corner.empty(); corner = in.token_on_line()) {
        if (corner.find_first_not_of("+-0123456789/") != corner.npos)
            in.fail("expected a face's corner such as 3, 3/1 or 3/1/2, but found " + in_quotes(corner));
        const std::int64_t index = in.to_integer(corner.substr(0, corner.find('/')), "a face's vertex");
        if (index == 0) in.fail("a face uses vertex 0, but OBJ counts vertices from 1");
        const auto count = static_cast<std::int64_t>(mesh.vertices.size());
        if (index < -count)
            in.fail("a face uses vertex " + std::to_string(index) + ", counted back from the last, but only " +
                    std::to_string(count) + " vertices stand before it: the file is damaged, export it again");
        mesh.corners.push_back(index > 0 ? index - 1 : count + index);
    }
    mesh.end_polygon(line);
}

}  // namespace

PolygonMesh read_obj(const MeshFile& file) {
    PolygonMesh mesh;
    mesh.first_index = 1;
    TextScanner in(file);
    in.join_continued_lines();
    OpenPart object, group;
    do {
        const std::string_view keyword = in.token_on_line();
        if (keyword == "v") {
            const double x = in.number_on_line("a vertex's x");
            const double y = in.number_on_line("a vertex's y");
            mesh.vertices.push_back({x, y, in.number_on_line("a vertex's z")});
        } else if (keyword == "f") {
            read_face(in, mesh);
        } else if (keyword == "o") {
            group.reopen(mesh, "");
            object.reopen(mesh, in.rest_of_line());
        } else if (keyword == "g") {
            group.reopen(mesh, in.rest_of_line());
        } else if (keyword.find('\0') != keyword.npos) {
            in.fail("a zero byte: this is no OBJ text, check that the file's ending fits its content");
        }
    } while (in.next_line());
    group.reopen(mesh, "");
    object.reopen(mesh, "");
    return mesh;
}

}  // namespace phyxel
