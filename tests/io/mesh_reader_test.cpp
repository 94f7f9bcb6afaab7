#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "io/mesh_reader_formats.h"
#include "phyxel/error.h"
#include "phyxel/mesh.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

using namespace phyxel;

namespace {

TriangleMesh read_text(const std::string& name, const std::string& content, const std::string& part = {}) {
    const test::TemporaryDirectory folder;
    test::write_bytes(folder / name, content);
    return read_mesh(folder / name, part);
}

/// Six times the volume: 1 for the tetrahedron of the unit corners, however it is stored.
double six_volumes(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c]));
    return sum;
}

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a])) / 2;
    return sum;
}

void expect_tetrahedron(const TriangleMesh& mesh) {
    EXPECT_EQ(mesh.triangles.size(), 4u);
    EXPECT_DOUBLE_EQ(six_volumes(mesh), 1);
}

template <class Value>
std::string bytes_of(Value value, bool big_endian = false) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

constexpr float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

const std::string obj_tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string off_tetrahedron = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string binary_stl(const std::string& header = "binary") {
    std::string bytes = header + std::string(80 - header.size(), ' ') + bytes_of(std::uint32_t{4});
    for (const auto& face : faces) {
        bytes += std::string(12, '\0');
        for (const int v : face)
            for (const float x : corners[v]) bytes += bytes_of(x);
        bytes += std::string(2, '\0');
    }
    return bytes;
}

std::string text_stl(int first, int last, const std::string& name) {
    std::string text = "solid " + name + "\n";
    for (int f = first; f < last; ++f) {
        text += "  facet normal nan 0 0\n    outer loop\n";
        for (const int v : faces[f])
            text += "      vertex " + std::to_string(corners[v][0]) + " " + std::to_string(corners[v][1]) + " " +
                    std::to_string(corners[v][2]) + "\n";
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid " + name + "\n";
}

/// Properties in an unusual order, of all kinds, with an element and lists that are to be skipped.
std::string ply_header(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment made by a test\nelement camera 1\nproperty list uchar float pose\nelement vertex 4\n"
           "property uchar red\nproperty double z\nproperty float x\nproperty list ushort short extra\nproperty float "
           "y\n"
           "element face 4\nproperty float quality\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string text_ply() {
    std::string text = ply_header("ascii") + "2 0.5 0.25\n";
    for (const auto& x : corners)
        text += "255 " + std::to_string(x[2]) + " " + std::to_string(x[0]) + " 1 7 " + std::to_string(x[1]) + "\n";
    for (const auto& f : faces)
        text += "nan 3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
    return text;
}

std::string binary_ply(bool big) {
    const auto put = [&](auto value) { return bytes_of(value, big); };
    std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
    bytes += put(std::uint8_t{2}) + put(0.5f) + put(0.25f);
    for (const auto& x : corners)
        bytes += put(std::uint8_t{255}) + put(double{x[2]}) + put(x[0]) + put(std::uint16_t{1}) +
                 put(std::int16_t{-7}) + put(x[1]);
    for (const auto& f : faces) bytes += put(NAN) + put(std::uint8_t{3}) + put(f[0]) + put(f[1]) + put(f[2]);
    return bytes;
}

/// Two nodes of one mesh: one moved, one mirrored.
std::string gltf_json(const std::string& buffer, const std::string& indices_count = "12") {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
      "nodes":[{"name":"moved","mesh":0,"translation":[5,0,0]},{"name":"mirrored","mesh":0,"scale":[-1,1,1]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "buffers":[)" +
           buffer + R"(],
      "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                   {"bufferView":1,"componentType":5123,"count":)" +
           indices_count + R"(,"type":"SCALAR"}]})";
}

std::string gltf_buffer(std::uint16_t first_index = 0) {
    std::string bytes;
    for (const auto& x : corners)
        for (const float value : x) bytes += bytes_of(value);
    for (const auto& f : faces)
        for (const int v : f)
            bytes += bytes_of(static_cast<std::uint16_t>(&f == &faces[0] && v == 0 ? first_index : v));
    return bytes;
}

std::string glb(std::string json, const std::string& binary) {
    while (json.size() % 4) json += ' ';
    const auto chunk = [](const std::string& data, std::uint32_t type) {
        return bytes_of(static_cast<std::uint32_t>(data.size())) + bytes_of(type) + data;
    };
    const std::string chunks = chunk(json, 0x4E4F534A) + chunk(binary, 0x004E4942);
    return "glTF" + bytes_of(std::uint32_t{2}) + bytes_of(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

const std::string glb_tetrahedra = glb(gltf_json(R"({"byteLength":72})"), gltf_buffer());

}  // namespace

TEST(MeshReader, same_tetrahedron_from_every_format) {
    expect_tetrahedron(read_text("t.obj", obj_tetrahedron));
    expect_tetrahedron(read_text("t.OFF", off_tetrahedron));
    expect_tetrahedron(read_text("t.stl", binary_stl()));
    expect_tetrahedron(read_text("t.stl", binary_stl("solid but binary")));
    expect_tetrahedron(read_text("t.stl", text_stl(0, 4, "t")));
    expect_tetrahedron(read_text("t.ply", text_ply()));
    expect_tetrahedron(read_text("t.ply", binary_ply(false)));
    expect_tetrahedron(read_text("t.ply", binary_ply(true)));
    expect_tetrahedron(read_text("t.glb", glb_tetrahedra, "mirrored"));
}

TEST(MeshReader, obj_indices_continuations_line_ends_and_colours_in_all_their_forms) {
    expect_tetrahedron(read_text("t.obj",
                                 "# c\r\nv 0 0 0 0.5 0.5 0.5\r\nv 1e0 0 0\r\nv +0 10E-1 0 1.0\r\nv 0 \\\r\n 0 1\r\n"
                                 "vt 0 0\r\nvn 0 0 1\r\nusemtl x\r\ns off\r\nf 1/1 3/1/1 2//1\r\nf -4 -3 -1\r\n"
                                 "f 1 4 \\\r\n3\r\nf 2 3 4 # end"));
}

TEST(MeshReader, off_with_colours_comments_and_counts_on_the_first_line) {
    expect_tetrahedron(
        read_text("t.off",
                  "COFF 4 4 0 # counts\n\n# corners\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n0 0 1 255 0 0\n"
                  "3 0 2 1 0.5 0.5 0.5\n3 0 1 3\n3  0 3 2\n3 1 2 3"));
    expect_tetrahedron(read_text("t.off", off_tetrahedron.substr(4)));
}

TEST(MeshReader, gltf_nodes_are_parts_in_their_places) {
    const TriangleMesh both = read_text("t.glb", glb_tetrahedra);
    EXPECT_EQ(both.parts.size(), 2u);
    EXPECT_DOUBLE_EQ(six_volumes(both), 2);
    EXPECT_EQ(read_text("t.glb", glb_tetrahedra, "moved").vertices[0].x, 5);
    const test::TemporaryDirectory folder;
    test::write_bytes(folder / "t.bin", gltf_buffer());
    test::write_bytes(folder / "t.gltf", gltf_json(R"({"byteLength":72,"uri":"t.bin"})"));
    expect_tetrahedron(read_mesh(folder / "t.gltf", "moved"));
}

TEST(MeshReader, parts_are_chosen_by_name) {
    const std::string text =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\no body\nf 1 3 2\ng cap\nf 1 2 4\no other one\nf 1 4 3\n";
    EXPECT_EQ(read_text("t.obj", text).triangles.size(), 4u);
    EXPECT_EQ(read_text("t.obj", text, "body").triangles.size(), 2u);
    EXPECT_EQ(read_text("t.obj", text, "cap").triangles.size(), 1u);
    EXPECT_EQ(read_text("t.obj", text, "other one").vertices.size(), 3u);
    EXPECT_EQ(read_text("t.stl", text_stl(0, 1, "a") + text_stl(1, 4, "b"), "b").triangles.size(), 3u);
    try {
        read_text("t.obj", text, "lid");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("\"body\", \"cap\""), std::string::npos) << error.what();
    }
}

TEST(MeshReader, polygons_are_cut_without_leaving_their_outline) {
    const auto polygon = [](const std::string& points, int n) {
        std::string text = points + "f";
        for (int i = 1; i <= n; ++i) text.append(" ").append(std::to_string(i));
        return read_text("t.obj", text);
    };
    const TriangleMesh arrow = polygon("v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\n", 4);
    EXPECT_EQ(arrow.triangles.size(), 2u);
    EXPECT_DOUBLE_EQ(area(arrow), 2);
    const TriangleMesh comb = polygon(
        "v 0 0 5\nv 5 0 5\nv 5 3 5\nv 4 3 5\nv 4 1 5\nv 3 1 5\nv 3 3 5\nv 2 3 5\nv 2 1 5\nv 1 1 5\nv 1 3 5\nv 0 3 5\n",
        12);
    EXPECT_EQ(comb.triangles.size(), 10u);
    EXPECT_DOUBLE_EQ(area(comb), 11);
    const TriangleMesh pentagon = polygon("v 1 0 0\nv 0.3 0.95 0\nv -0.8 0.6 0\nv -0.8 -0.6 0\nv 0.3 -0.95 0\n", 5);
    EXPECT_EQ(pentagon.triangles.size(), 3u);
    EXPECT_EQ(polygon("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\n", 4).triangles.size(), 2u) << "crosses itself";
}

TEST(MeshReader, ply_triangle_strips_become_triangles_of_one_sense) {
    // The tetrahedron as one strip of four triangles
    expect_tetrahedron(read_text("t.ply",
                                 "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                 "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                                 "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n7 -1 0 2 1 3 0 2\n"));
}

TEST(MeshReader, numbers_do_not_depend_on_the_locale_and_keep_all_digits) {
    const TriangleMesh mesh = read_text("t.obj", "v 0.1234567890123456 1e30 1e-400\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(mesh.vertices[0], (Vec3{0.1234567890123456, 1e30, 0}));
}

TEST(MeshReader, malformed_files_are_refused_with_the_place_and_a_remedy) {
    const std::string ply = text_ply(), binary = binary_ply(false), stl = binary_stl(),
                      json = gltf_json(R"({"byteLength":72})");
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    std::string noise;
    for (unsigned i = 0, state = 1; i < 4000; ++i)
        noise += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
    struct Case {
        const char* name;
        std::string content, expected;  // in the message
    };
    const std::vector<Case> cases = {
        {"empty.obj", "", "empty"},
        {"empty.ply", "", "empty"},
        {"blank.obj", "\n\n", "no triangle"},
        {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangle"},
        {"cut.obj", "v 0 0 0\nv 1 0", "line 2"},
        {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: a face uses vertex 4"},
        {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4"},
        {"negative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "line 4"},
        {"huge.obj", "v 0 0 0\nf 1 1 99999999999999999999999\n", "line 2"},
        {"big.obj", "v 0 0 0\nf 1 1 4294967297\n", "line 2"},
        {"two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "at least 3"},
        {"none.obj", "v 0 0 0\nf\n", "line 2"},
        {"nan.obj", "v 0 0 nan\n", "line 1: a vertex's z is \"nan\""},
        {"inf.obj", "v 0 -inf 0\n", "finite"},
        {"overflow.obj", "v 0 1e999 0\n", "finite"},
        {"word.obj", "v 0 zero 0\n", "\"zero\""},
        {"comma.obj", "v 0,5 0 0\n", "\"0,5\""},
        {"corner.obj", "v 0 0 0\nf 1/x 1 1\n", "line 2"},
        {"noise.obj", noise, "noise.obj"},
        {"noise.ply", noise, "line 1"},
        {"noise.stl", noise, "byte 80"},
        {"noise.off", noise, "line"},
        {"noise.glb", noise, "noise.glb"},
        {"noise.gltf", noise, "noise.gltf"},
        {"word.off", "hello\n", "\"hello\""},
        {"four.off", "4OFF\n1 1 1\n0 0 0 0\n", "three"},
        {"binary.off", "OFF BINARY\n", "text"},
        {"counts.off", "OFF\n4\n", "line"},
        {"many.off", "OFF\n4000000000 4 6\n0 0 0\n", "4000000000"},
        {"manyfaces.off", "OFF\n4 999999999999 6\n0 0 0\n", "999999999999"},
        {"below.off", "OFF\n-4 4 6\n0 0 0\n", "-4"},
        {"cut.off", off_tetrahedron.substr(0, off_tetrahedron.size() - 10), "truncated"},
        {"index.off", replaced(off_tetrahedron, "3 1 2 3", "3 1 2 4"), "line 10"},
        {"minus.off", replaced(off_tetrahedron, "3 1 2 3", "3 1 2 -3"), "line 10"},
        {"corners.off", replaced(off_tetrahedron, "3 1 2 3", "-3 1 2 3"), "line 10"},
        {"long.off", replaced(off_tetrahedron, "3 1 2 3", "3000000000 1 2 3"), "line 10"},
        {"nan.off", replaced(off_tetrahedron, "1 0 0", "nan 0 0"), "line 4"},
        {"magic.ply", "plx\n", "line 1"},
        {"header.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "header"},
        {"format.ply", "ply\nformat utf8 1.0\n", "\"utf8\""},
        {"noformat.ply", "ply\nend_header\n", "format"},
        {"type.ply", replaced(ply, "property double z", "property quad z"), "\"quad\""},
        {"listcount.ply", replaced(ply, "list uchar int", "list float int"), "whole"},
        {"orphan.ply", "ply\nformat ascii 1.0\nproperty float x\n", "line 3"},
        {"noz.ply", replaced(ply, "double z", "double w"), "x, y and z"},
        {"noindices.ply", replaced(ply, "vertex_indices", "corners"), "vertex_indices"},
        {"many.ply", replaced(ply, "element vertex 4", "element vertex 4000000000"), "4000000000"},
        {"manybinary.ply", replaced(binary, "element face 4", "element face 9000000000000000000"),
         "9000000000000000000"},
        {"overflow.ply", replaced(ply, "element vertex 4", "element vertex 99999999999999999999"), "line"},
        {"below.ply", replaced(ply, "element vertex 4", "element vertex -4"), "-4"},
        {"cut.ply", ply.substr(0, ply.size() - 4), "truncated"},
        {"cutbinary.ply", binary.substr(0, binary.size() - 3), "byte"},
        {"index.ply", replaced(ply, "3 1 2 3", "3 1 2 9"), "vertex 9"},
        {"fraction.ply", replaced(ply, "3 1 2 3", "3 1 2 2.5"), "whole"},
        {"listlength.ply", replaced(ply, "3 1 2 3", "2000000000 1 2 3"), "2000000000"},
        {"nan.ply", replaced(ply, "255 0.000000", "255 nan"), "finite"},
        {"cut.stl", stl.substr(0, stl.size() - 1), "byte 80"},
        {"header.stl", stl.substr(0, 50), "byte 50"},
        {"many.stl", stl.substr(0, 80) + bytes_of(~0u) + stl.substr(84), "4294967295"},
        {"none.stl", stl.substr(0, 80) + bytes_of(0u), "no triangle"},
        {"nan.stl", stl.substr(0, 96) + bytes_of(NAN) + stl.substr(100), "byte 96"},
        {"cuttext.stl", text_stl(0, 4, "t").substr(0, 300), "truncated"},
        {"word.stl", "solid t\nfacet normal 0 0 1\nhello\n", "\"hello\""},
        {"facet.stl", replaced(text_stl(0, 4, "t"), "vertex 0.000000 0.000000 0.000000\n", "\n"), "2 vertices"},
        {"infinity.stl", replaced(text_stl(0, 4, "t"), "vertex 0.000000", "vertex inf"), "line 4"},
        {"cut.glb", glb_tetrahedra.substr(0, glb_tetrahedra.size() - 20), "byte 8"},
        {"short.glb", glb_tetrahedra.substr(0, 15), "header"},
        {"version.glb", replaced(glb_tetrahedra, std::string("glTF\2", 5), std::string("glTF\1", 5)), "version 2"},
        {"buffer.glb", glb(gltf_json(R"({"byteLength":7200})"), gltf_buffer()), "buffers[0]"},
        {"view.glb", glb(replaced(json, "\"byteLength\":24", "\"byteLength\":2400"), gltf_buffer()), "bufferViews[1]"},
        {"accessor.glb", glb(gltf_json(R"({"byteLength":72})", "1200000000"), gltf_buffer()), "accessors[1]"},
        {"reference.glb", glb(replaced(json, "\"indices\":1", "\"indices\":7"), gltf_buffer()), "meshes[0]"},
        {"index.glb", glb(json, gltf_buffer(77)), "index.glb"},
        {"cycle.glb", glb(replaced(json, "\"mesh\":0,\"scale\":[-1,1,1]", "\"children\":[1]"), gltf_buffer()),
         "nodes[1]"},
        {"json.gltf", "{\"asset\":", "byte"},
        {"list.gltf", "[1, 2]", "asset"},
        {"beside.gltf", gltf_json(R"({"byteLength":72,"uri":"gone.bin"})"), "gone.bin"},
        {"base64.gltf", gltf_json(R"({"byteLength":72,"uri":"data:application/octet-stream;base64,AAA*"})"), "base64"},
        {"type.gltf", "{\"asset\":{},\"buffers\":7}", "buffers"},
        {"unknown.fbx", "x", ".fbx"},
        {"noending", "x", "ending"},
    };
    EXPECT_GE(cases.size(), 40u);
    for (const Case& c : cases) {
        try {
            read_text(c.name, c.content);
            ADD_FAILURE() << c.name << " was read";
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_NE(message.find(c.name), std::string::npos) << message;
            EXPECT_NE(message.find(c.expected), std::string::npos) << c.name << ": " << message;
        }
    }
}

TEST(MeshReader, every_truncation_is_read_or_refused) {
    struct Case {
        const char* name;
        std::string content;
    };
    for (const auto& [name, content] :
         {Case{"t.obj", obj_tetrahedron}, Case{"t.off", off_tetrahedron}, Case{"t.ply", text_ply()},
          Case{"t.ply", binary_ply(true)}, Case{"t.stl", binary_stl()}, Case{"t.stl", text_stl(0, 2, "t")},
          Case{"t.glb", glb_tetrahedra}}) {
        const test::TemporaryDirectory folder;
        for (std::size_t size = 0; size < content.size(); size += 3) {
            test::write_bytes(folder / name, content.substr(0, size));
            try {
                EXPECT_FALSE(read_mesh(folder / name).triangles.empty());
            } catch (const Error&) {
            }
        }
    }
}

TEST(MeshReader, damaged_bytes_never_crash) {
    unsigned state = 5;
    const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
    for (const auto& [name, content] : {std::pair{"t.ply", binary_ply(false)}, std::pair{"t.stl", binary_stl()},
                                        std::pair{"t.glb", glb_tetrahedra}, std::pair{"t.obj", obj_tetrahedron}}) {
        const test::TemporaryDirectory folder;
        for (int round = 0; round < 200; ++round) {
            std::string damaged = content;
            for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
            test::write_bytes(folder / name, damaged);
            try {
                read_mesh(folder / name);
            } catch (const Error&) {
            }
        }
    }
}

TEST(MeshReader, folders_and_missing_files_are_refused) {
    const test::TemporaryDirectory folder;
    std::filesystem::create_directory(folder / "t.obj");
    for (const char* name : {"t.obj", "gone.ply"}) EXPECT_THROW(read_mesh(folder / name), Error) << name;
}

TEST(MeshReader, reads_the_bunny) {
    const TriangleMesh mesh = read_mesh(PHYXEL_SOURCE_DIR "/scenes/meshes/bunny.obj");
    EXPECT_EQ(mesh.triangles.size(), 3674u);
    EXPECT_EQ(mesh.vertices.size(), 1839u);
}
