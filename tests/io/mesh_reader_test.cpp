#include <gtest/gtest.h>

#include "phyxel/error.h"
#include "phyxel/mesh.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"
using namespace phyxel;
TEST(MeshReader, reads_the_bunny) {
    const TriangleMesh mesh = read_mesh(PHYXEL_SOURCE_DIR "/scenes/meshes/bunny.obj");
    EXPECT_GT(mesh.triangles.size(), 1000u);
}
