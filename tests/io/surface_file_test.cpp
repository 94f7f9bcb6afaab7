#include "io/surface_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <sstream>
#include <vector>

#include "io/tetrahedron.h"
#include "phyxel/error.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::read_bytes;
using test::TemporaryDirectory;

const std::vector<Vec3f> positions = {{0, 0, 0}, {1.0f / 3, 0, 0}, {0, 1e-20f, 0}, {0, 0, -7e10f}};

template <class T>
T take(const std::string& bytes, std::size_t& at) {
    T value;
    std::memcpy(&value, bytes.substr(at, sizeof value).data(), sizeof value);
    at += sizeof value;
    return value;
}

TEST(Ply, without_normals_is_exactly_the_form_of_fragments) {
    const TemporaryDirectory folder;
    write_ply(folder / "a.ply", {positions, tetrahedron_faces});
    const std::string bytes = read_bytes(folder / "a.ply");
    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    ASSERT_EQ(bytes.substr(0, header.size()), header);
    ASSERT_EQ(bytes.size(), header.size() + 4 * 12 + 4 * 13);
    std::size_t at = header.size();
    for (const Vec3f& p : positions) EXPECT_EQ(take<Vec3f>(bytes, at), p);
    for (const Triangle& t : tetrahedron_faces) {
        EXPECT_EQ(take<std::uint8_t>(bytes, at), 3);
        EXPECT_EQ(take<Triangle>(bytes, at), t);
    }
}

TEST(Ply, holds_normals_and_scalars_with_each_vertex) {
    const TemporaryDirectory folder;
    const std::vector<float> heat = {1, 2, 3, 4};
    const VertexScalar scalars[] = {{"von_mises", heat}};
    write_ply(folder / "a.ply", {positions, tetrahedron_faces, positions, scalars});
    const std::string bytes = read_bytes(folder / "a.ply");
    EXPECT_NE(bytes.find("property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                         "property float von_mises\nelement face 4\n"),
              std::string::npos);
    std::size_t at = bytes.find("end_header\n") + 11;
    for (std::size_t v = 0; v < positions.size(); ++v) {
        EXPECT_EQ(take<Vec3f>(bytes, at), positions[v]);
        EXPECT_EQ(take<Vec3f>(bytes, at), positions[v]);
        EXPECT_EQ(take<float>(bytes, at), heat[v]);
    }
    EXPECT_EQ(bytes.size(), at + 4 * 13);
}

TEST(Obj, reads_back_as_the_same_surface) {
    const TemporaryDirectory folder;
    write_obj(folder / "a.obj", {positions, tetrahedron_faces, positions});
    std::istringstream text(read_bytes(folder / "a.obj"));
    std::vector<Vec3f> read_positions, read_normals;
    std::vector<Triangle> read_triangles;
    for (std::string kind; text >> kind;) {
        if (kind == "v" || kind == "vn") {
            std::string x, y, z;
            text >> x >> y >> z;
            (kind == "v" ? read_positions : read_normals).push_back({std::stof(x), std::stof(y), std::stof(z)});
        } else {
            ASSERT_EQ(kind, "f");
            Triangle& t = read_triangles.emplace_back();
            for (std::uint32_t& corner : t) {
                std::string field;
                text >> field;
                const std::size_t slashes = field.find("//");
                ASSERT_NE(slashes, std::string::npos);
                corner = static_cast<std::uint32_t>(std::stoul(field)) - 1;
                EXPECT_EQ(std::stoul(field.substr(slashes + 2)), corner + 1);
            }
        }
    }
    EXPECT_EQ(read_positions, positions);
    EXPECT_EQ(read_normals, positions);
    EXPECT_EQ(read_triangles, tetrahedron_faces);
}

TEST(Obj, without_normals_has_plain_faces) {
    const TemporaryDirectory folder;
    write_obj(folder / "a.obj", {positions, tetrahedron_faces});
    const std::string text = read_bytes(folder / "a.obj");
    EXPECT_EQ(text.substr(0, 8), "v 0 0 0\n");
    EXPECT_NE(text.find("f 1 3 2\n"), std::string::npos);
    EXPECT_EQ(text.find("vn"), std::string::npos);
}

TEST(SurfaceFile, never_holds_a_value_that_is_not_finite) {
    const TemporaryDirectory folder;
    std::vector<Vec3f> lost = positions;
    lost[2].y = std::nanf("");
    std::vector<float> heat = {1, 2, std::nanf(""), 4};
    const VertexScalar scalars[] = {{"heat", heat}};
    for (const auto write : {write_ply, write_obj}) {
        EXPECT_THROW(write(folder / "a", {lost, tetrahedron_faces}), Error);
        EXPECT_THROW(write(folder / "a", {positions, tetrahedron_faces, lost}), Error);
        EXPECT_THROW(write(folder / "a", {positions, tetrahedron_faces, {}, scalars}), Error);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace phyxel
