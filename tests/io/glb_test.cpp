#include "io/glb.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "io/tetrahedron.h"
#include "phyxel/error.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::read_bytes;
using test::TemporaryDirectory;

const std::vector<Vec3f> up(4, Vec3f{0, 1, 0});

std::vector<Vec3f> moved(std::vector<Vec3f> points, const Vec3f& by) {
    for (Vec3f& p : points) p += by;
    return points;
}

/// Two bodies; the second one falls by 0.1 a frame.
void write_fall(const std::filesystem::path& path, std::size_t frames) {
    const GlbMesh meshes[] = {{"rock", tetrahedron_faces, {1, 0, 0}}, {"jelly", tetrahedron_faces}};
    GlbWriter writer(path, meshes);
    for (std::size_t frame = 0; frame < frames; ++frame) {
        const auto height = static_cast<float>(frame) * -0.1f;
        const std::vector<Vec3f> falling = moved(tetrahedron, {3, height, 0});
        const GlbPose poses[] = {{tetrahedron, up}, {falling, up}};
        writer.add_frame(static_cast<double>(frame) / 60, poses);
    }
    writer.finish();
}

struct Container {
    nlohmann::json index;
    std::string data;
};

std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.substr(at, 4).data(), 4);
    return value;
}

/// Takes the container apart and checks its lengths and alignment.
Container open_container(const std::filesystem::path& path) {
    const std::string bytes = read_bytes(path);
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(bytes, 4), 2u);
    EXPECT_EQ(word(bytes, 8), bytes.size());
    const std::uint32_t length = word(bytes, 12);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(length % 4, 0u);
    const std::size_t binary = 20 + length;
    EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(word(bytes, binary) % 4, 0u);
    EXPECT_EQ(binary + 8 + word(bytes, binary), bytes.size());
    return {nlohmann::json::parse(bytes.substr(20, length)), bytes.substr(binary + 8)};
}

std::vector<float> floats(const Container& container, std::size_t accessor) {
    const auto& a = container.index["accessors"][accessor];
    const auto& view = container.index["bufferViews"][a["bufferView"].get<std::size_t>()];
    std::vector<float> values(a["count"].get<std::size_t>() * (a["type"] == "VEC3" ? 3 : 1));
    const std::size_t begin = view["byteOffset"].get<std::size_t>() + a["byteOffset"].get<std::size_t>();
    std::memcpy(values.data(), container.data.substr(begin, 4 * values.size()).data(), 4 * values.size());
    return values;
}

TEST(Glb, arrays_lie_within_views_within_the_data_and_hold_their_extents) {
    const TemporaryDirectory folder;
    write_fall(folder / "a.glb", 5);
    const Container file = open_container(folder / "a.glb");
    EXPECT_EQ(file.index["asset"]["version"], "2.0");
    EXPECT_EQ(file.index["buffers"][0]["byteLength"], file.data.size());
    for (std::size_t i = 0; i < file.index["accessors"].size(); ++i) {
        const auto& accessor = file.index["accessors"][i];
        const auto& view = file.index["bufferViews"][accessor["bufferView"].get<std::size_t>()];
        const std::size_t size = accessor["count"].get<std::size_t>() * (accessor["type"] == "VEC3" ? 12 : 4);
        EXPECT_LE(accessor["byteOffset"].get<std::size_t>() + size, view["byteLength"].get<std::size_t>());
        EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), file.data.size());
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
        if (!accessor.contains("min")) continue;
        const std::vector<float> values = floats(file, i);
        const std::size_t width = accessor["min"].size();
        for (std::size_t axis = 0; axis < width; ++axis) {
            float lower = values[axis], upper = values[axis];
            for (std::size_t v = axis; v < values.size(); v += width) {
                lower = std::min(lower, values[v]);
                upper = std::max(upper, values[v]);
            }
            EXPECT_EQ(accessor["min"][axis].get<float>(), lower);
            EXPECT_EQ(accessor["max"][axis].get<float>(), upper);
        }
    }
}

TEST(Glb, every_frame_shows_the_pose_that_was_added) {
    const TemporaryDirectory folder;
    const std::size_t frames = 6;
    write_fall(folder / "a.glb", frames);
    const Container file = open_container(folder / "a.glb");
    const auto& sampler = file.index["animations"][0]["samplers"][0];
    const std::vector<float> times = floats(file, sampler["input"]), weights = floats(file, sampler["output"]);
    const auto& primitive = file.index["meshes"][1]["primitives"][0];
    const std::vector<float> base = floats(file, primitive["attributes"]["POSITION"]);
    ASSERT_EQ(primitive["targets"].size(), frames - 1);
    for (std::size_t frame = 0; frame < frames; ++frame) {
        EXPECT_EQ(times[frame], static_cast<float>(static_cast<double>(frame) / 60));
        std::vector<float> shown = base;
        for (std::size_t target = 0; target < frames - 1; ++target) {
            const std::vector<float> offsets = floats(file, primitive["targets"][target]["POSITION"]);
            for (std::size_t i = 0; i < shown.size(); ++i)
                shown[i] += weights[frame * (frames - 1) + target] * offsets[i];
        }
        for (std::size_t v = 0; v < 4; ++v) {
            EXPECT_FLOAT_EQ(shown[3 * v], tetrahedron[v].x + 3);
            EXPECT_NEAR(shown[3 * v + 1], tetrahedron[v].y - 0.1f * static_cast<float>(frame), 1e-6f);
            EXPECT_FLOAT_EQ(shown[3 * v + 2], tetrahedron[v].z);
        }
    }
}

TEST(Glb, loads_in_another_program) {
    const TemporaryDirectory folder;
    write_fall(folder / "a.glb", 7);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((folder / "a.glb").string(), aiProcess_ValidateDataStructure);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 2u);
    for (unsigned m = 0; m < 2; ++m) {
        const aiMesh& mesh = *scene->mMeshes[m];
        EXPECT_EQ(mesh.mNumVertices, 4u);
        EXPECT_EQ(mesh.mNumFaces, 4u);
        EXPECT_EQ(mesh.mNumAnimMeshes, 6u);
        EXPECT_TRUE(mesh.HasNormals());
    }
    // assimp gives the targets' own positions.
    EXPECT_NEAR(scene->mMeshes[1]->mAnimMeshes[5]->mVertices[2].y, 1 - 0.6f, 1e-6f);
    ASSERT_EQ(scene->mNumAnimations, 1u);
    ASSERT_EQ(scene->mAnimations[0]->mNumMorphMeshChannels, 2u);
    EXPECT_EQ(scene->mAnimations[0]->mMorphMeshChannels[0]->mNumKeys, 7u);
    aiColor4D color;
    scene->mMaterials[scene->mMeshes[0]->mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, color);
    EXPECT_EQ(color, aiColor4D(1, 0, 0, 1));
}

TEST(Glb, of_one_frame_is_a_still) {
    const TemporaryDirectory folder;
    write_fall(folder / "a.glb", 1);
    const Container file = open_container(folder / "a.glb");
    EXPECT_FALSE(file.index.contains("animations"));
    EXPECT_FALSE(file.index["meshes"][0]["primitives"][0].contains("targets"));
    Assimp::Importer importer;
    EXPECT_NE(importer.ReadFile((folder / "a.glb").string(), aiProcess_ValidateDataStructure), nullptr)
        << importer.GetErrorString();
}

TEST(Glb, leaves_out_a_frame_that_is_not_later_than_the_last) {
    const TemporaryDirectory folder;
    const GlbMesh meshes[] = {{"jelly", tetrahedron_faces}};
    GlbWriter writer(folder / "a.glb", meshes);
    const GlbPose pose[] = {{tetrahedron, up}};
    for (const double time : {0.0, 0.5, 0.5, 0.25, 0.5 + 1e-12, 1.0}) writer.add_frame(time, pose);
    EXPECT_EQ(writer.frames(), 3u);
}

TEST(Glb, refuses_a_surface_that_changes) {
    const TemporaryDirectory folder;
    const GlbMesh meshes[] = {{"jelly", tetrahedron_faces}};
    GlbWriter writer(folder / "a.glb", meshes);
    const GlbPose first[] = {{tetrahedron, up}};
    writer.add_frame(0, first);
    const std::vector<Vec3f> more(5);
    const GlbPose second[] = {{more, more}};
    try {
        writer.add_frame(1, second);
        FAIL() << "was accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("\"jelly\" changed from 4 to 5 vertices"), std::string::npos);
    }
}

TEST(Glb, refuses_to_grow_beyond_what_the_format_holds) {
    const TemporaryDirectory folder;
    const GlbMesh meshes[] = {{"jelly", tetrahedron_faces}};
    GlbWriter writer(folder / "a.glb", meshes);
    const GlbPose pose[] = {{tetrahedron, up}};
    std::string message;
    try {
        for (int frame = 0; frame < 40000; ++frame) writer.add_frame(frame, pose);
    } catch (const Error& error) {
        message = error.what();
    }
    EXPECT_NE(message.find("would exceed the 4 GiB"), std::string::npos) << message;
    EXPECT_NE(message.find("lower the frame rate"), std::string::npos) << message;
    EXPECT_GT(writer.frames(), 30000u);
}

TEST(Glb, never_holds_a_value_that_is_not_finite) {
    const TemporaryDirectory folder;
    const GlbMesh meshes[] = {{"jelly", tetrahedron_faces}};
    GlbWriter writer(folder / "a.glb", meshes);
    std::vector<Vec3f> lost = tetrahedron;
    lost[3].z = std::nanf("");
    const GlbPose bad_positions[] = {{lost, up}}, bad_normals[] = {{tetrahedron, lost}};
    EXPECT_THROW(writer.add_frame(0, bad_positions), Error);
    EXPECT_THROW(writer.add_frame(0, bad_normals), Error);
    EXPECT_EQ(writer.frames(), 0u);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace phyxel
