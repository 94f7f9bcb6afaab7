#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "io/glb.h"
#include "io/surface_file.h"
#include "io/vtu.h"
#include "phyxel/error.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::TemporaryDirectory;

struct Writer {
    const char* name;
    std::function<void(const std::filesystem::path&)> write;
};

/// Every writer of numbers, with something small to write.
std::vector<Writer> all_writers() {
    static const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const std::vector<Vec3> nodes = {{0, 0, 0}, {1, 0, 0}};
    static const std::vector<Triangle> triangles = {{0, 1, 2}};
    using Path = std::filesystem::path;
    return {{"vtu points", [](const Path& path) { write_vtu_points(path, nodes, {}); }},
            {"vtu surface", [](const Path& path) { write_vtu_surface(path, points, triangles, {}, {1}); }},
            {"pvd", [](const Path& path) { write_pvd(path, {}); }},
            {"ply",
             [](const Path& path) {
                 write_ply(path, {points, triangles});
             }},
            {"obj",
             [](const Path& path) {
                 write_obj(path, {points, triangles});
             }},
            {"glb", [](const Path& path) {
                 const GlbMesh mesh[] = {{"body", triangles}};
                 GlbWriter writer(path, mesh);
                 const GlbPose pose[] = {{points, points}};
                 writer.add_frame(0, pose);
                 writer.finish();
             }}};
}

TEST(FullDisk, is_an_error_of_every_writer_and_leaves_nothing) {
    for (const Writer& writer : all_writers()) {
        const TemporaryDirectory folder;
        std::filesystem::create_symlink("/dev/full", folder / ".file.part");
        try {
            writer.write(folder / "file");
            ADD_FAILURE() << writer.name << " wrote on a full disk";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("no space left on"), std::string::npos) << error.what();
        }
        EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << writer.name;
    }
}

TEST(MissingFolder, is_an_error_of_every_writer) {
    const TemporaryDirectory folder;
    for (const Writer& writer : all_writers())
        EXPECT_THROW(writer.write(folder / "missing" / "file"), Error) << writer.name;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace phyxel
