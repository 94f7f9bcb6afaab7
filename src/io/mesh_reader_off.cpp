#include <algorithm>

#include "io/mesh_reader_text.h"

/// Geomview OFF: an optional keyword (OFF, with C, N or ST before it when colours, normals or texture follow the
/// positions), the counts of vertices, faces and edges, then one vertex or face a line. Colours are skipped.

namespace phyxel {

namespace {

/// Reads the keyword; leaves the scanner before the counts.
void read_keyword(TextScanner& in, const MeshFile& file) {
    TextScanner ahead = in;
    std::string_view keyword = ahead.token();
    double ignored;
    if (parse_number(keyword, ignored)) return;
    in = ahead;
    if (!keyword.ends_with("OFF"))
        in.fail("expected OFF, COFF or NOFF, but found " + in_quotes(keyword) + ": this is no OFF file");
    keyword.remove_suffix(3);
    if (keyword.find_first_of("4n") != keyword.npos)
        in.fail("vertices of four or n coordinates: export the mesh with three");
    if (keyword.find_first_not_of("STCN") != keyword.npos)
        in.fail("expected OFF, COFF or NOFF, but found " + in_quotes(keyword) + " before OFF");
    ahead = in;
    if (ahead.token_on_line() == "BINARY") file.fail("", "binary OFF cannot be read: export it as text");
}

std::size_t read_count(TextScanner& in, const char* what, std::size_t smallest_record) {
    const std::int64_t count = in.to_integer(in.token(), what);
    if (count < 0 || static_cast<std::uint64_t>(count) > in.remaining_bytes() / smallest_record)
        in.fail(std::string(what) + " is given as " + std::to_string(count) +
                ", more than the file can hold: it is truncated or damaged, export it again");
    return static_cast<std::size_t>(count);
}

void require_record(TextScanner& in, const char* what, std::size_t number, std::size_t count) {
    if (!in.find_token())
        in.fail("the file ends after " + std::to_string(number) + " of " + std::to_string(count) + " " + what +
                ": it is truncated, export it again");
}

}  // namespace

PolygonMesh read_off(const MeshFile& file) {
    PolygonMesh mesh;
    TextScanner in(file);
    read_keyword(in, file);

    // Counts; the shortest records are "0 0 0" and "1 0", a line each
    const std::size_t vertices = read_count(in, "the number of vertices", 5);
    const std::size_t faces = read_count(in, "the number of faces", 3);
    in.next_line();

    mesh.vertices.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        require_record(in, "vertices", i, vertices);
        const double x = in.number_on_line("a vertex's x");
        const double y = in.number_on_line("a vertex's y");
        mesh.vertices.push_back({x, y, in.number_on_line("a vertex's z")});
        in.next_line();
    }
    for (std::size_t i = 0; i < faces; ++i) {
        require_record(in, "faces", i, faces);
        const std::size_t line = in.line();
        const std::int64_t corners = in.integer_on_line("a face's number of corners");
        if (corners < 0)
            in.fail("a face of " + std::to_string(corners) + " corners: the file is damaged, export it again");
        for (std::int64_t k = 0; k < corners; ++k) mesh.corners.push_back(in.integer_on_line("a face's vertex"));
        mesh.end_polygon(line);
        in.next_line();
    }
    return mesh;
}

}  // namespace phyxel
