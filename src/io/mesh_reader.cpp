#include <algorithm>
#include <array>
#include <fstream>

#include "io/mesh_reader_formats.h"
#include "phyxel/error.h"
#include "phyxel/mesh.h"

namespace phyxel {

namespace {

using Reader = PolygonMesh (*)(const MeshFile&);

struct Format {
    const char* ending;
    Reader read;
};
constexpr std::array<Format, 6> formats = {{{".obj", read_obj},
                                            {".ply", read_ply},
                                            {".stl", read_stl},
                                            {".off", read_off},
                                            {".gltf", read_gltf},
                                            {".glb", read_gltf}}};

Reader reader_for(const MeshFile& file) {
    std::string ending = file.path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    for (const Format& format : formats)
        if (ending == format.ending) return format.read;
    file.fail("", "the ending " + in_quotes(ending) +
                      " names no mesh format that can be read: use .obj, .ply, .stl, .off, .gltf or .glb");
}

void load(MeshFile& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file.path, error);
    if (!std::filesystem::exists(status)) file.fail("", "there is no such mesh file: check the path");
    if (std::filesystem::is_directory(status)) file.fail("", "is a folder: name the mesh file in it");
    if (!std::filesystem::is_regular_file(status)) file.fail("", "is not a regular file: copy the mesh into one");
    std::ifstream stream(file.path, std::ios::binary);
    const std::uintmax_t size = std::filesystem::file_size(file.path, error);
    if (!stream || error) file.fail("", "cannot be opened: check its permissions");
    if (size == 0) file.fail("", "is empty: export the mesh again");
    file.bytes.resize(size);
    stream.read(file.bytes.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(stream.gcount()) != size)
        file.fail("", "cannot be read to its end: check the disk");
}

/// The triangles of all parts called `part`, as one mesh.
TriangleMesh only_part(const TriangleMesh& mesh, const std::string& part, const MeshFile& file) {
    TriangleMesh kept;
    std::vector<std::uint32_t> new_index(mesh.vertices.size(), UINT32_MAX);
    std::vector<std::string> names;
    for (const TriangleMesh::Part& candidate : mesh.parts) {
        if (std::find(names.begin(), names.end(), candidate.name) == names.end()) names.push_back(candidate.name);
        if (candidate.name != part) continue;
        kept.parts.push_back({part, kept.triangles.size(), kept.triangles.size() + candidate.end - candidate.begin});
        for (std::size_t t = candidate.begin; t < candidate.end; ++t) {
            Triangle triangle = mesh.triangles[t];
            for (std::uint32_t& v : triangle) {
                if (new_index[v] == UINT32_MAX) {
                    new_index[v] = static_cast<std::uint32_t>(kept.vertices.size());
                    kept.vertices.push_back(mesh.vertices[v]);
                }
                v = new_index[v];
            }
            kept.triangles.push_back(triangle);
        }
    }
    if (!kept.triangles.empty()) return kept;
    std::string known;
    for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 10); ++i)
        known += (i ? ", " : "") + in_quotes(names[i]);
    if (names.size() > 10) known += " and " + std::to_string(names.size() - 10) + " more";
    file.fail("", "has no part " + in_quotes(part) + ": " +
                      (names.empty() ? "the file names no parts, leave the part out" : "its parts are " + known));
}

}  // namespace

void MeshFile::fail(const std::string& place, const std::string& message) const {
    throw Error(name + (place.empty() ? "" : ", " + place) + ": " + message);
}

std::string in_quotes(std::string_view token) {
    constexpr std::size_t longest = 40;
    std::string text(token.substr(0, longest));
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return "\"" + text + (token.size() > longest ? "...\"" : "\"");
}

TriangleMesh read_mesh(const std::filesystem::path& path, const std::string& part) {
    MeshFile file{.path = path, .name = path.string(), .bytes = {}};
    const Reader read = reader_for(file);
    load(file);
    TriangleMesh mesh = triangulate(read(file), file);
    if (mesh.triangles.empty()) file.fail("", "has no triangle: export the surface, not only points or curves");
    if (!part.empty()) mesh = only_part(mesh, part, file);
    mesh.source = file.name;
    return mesh;
}

}  // namespace phyxel
