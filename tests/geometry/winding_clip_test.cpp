#include <gtest/gtest.h>

#include "geometry/clipping.h"
#include "geometry/clipping_shapes.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

ClippedVolume clipped(const TriangleMesh& mesh, double pitch, int threads = 2) {
    return clip_by_winding_number(mesh, WindingNumber(mesh), pitch, Threads(threads));
}

TEST(ClipByWindingNumber, boundary_closes_and_spans_the_volume) {
    for (const auto& [name, mesh] : test_bodies()) {
        const TriangleMesh body = posed(mesh, 1);
        const ClippedVolume clip = clipped(body, body_size(body) / 13);
        const ClosureErrors errors = closure_errors(clip);
        EXPECT_LT(errors.area, 1e-13) << name;
        EXPECT_LT(errors.volume, 1e-13) << name;
    }
}

TEST(ClipByWindingNumber, agrees_with_exact_clipping_to_a_sub_voxel) {
    for (const auto& [name, mesh] : test_bodies()) {
        const TriangleMesh body = posed(mesh, 2);
        const double pitch = body_size(body) / 20;
        const ClippedVolume clip = clipped(body, pitch), exact = clip_closed(body, pitch, Threads(1));
        EXPECT_NEAR(clip.volume / exact.volume, 1, 0.01) << name;
    }
}

TEST(ClipByWindingNumber, an_overlap_counts_once) {
    TriangleMesh second = transformed(make_box({1, 1, 1}), Mat3::identity(), {0.5, 0, 0});
    const TriangleMesh both = joined(make_box({1, 1, 1}), second);
    EXPECT_NEAR(clip_closed(both, 0.1, Threads(1)).volume, 2, 1e-12);
    EXPECT_NEAR(clipped(both, 0.1).volume, 1.5, 1e-12) << "faces on octant planes";
    EXPECT_NEAR(clipped(posed(both, 1), 0.1).volume, 1.5, 0.01);
}

TEST(ClipByWindingNumber, faces_through_the_centres_of_sub_voxels_are_decided_alike_everywhere) {
    const double pitch = 0.25, half_voxel = pitch / 8;
    const TriangleMesh box = transformed(make_box({1, 1, 1}), Mat3::identity(), {half_voxel, half_voxel, half_voxel});
    EXPECT_NEAR(clipped(box, pitch).volume, 1, 1e-12);
}

TEST(ClipByWindingNumber, a_hole_is_closed) {
    TriangleMesh open = make_sphere(1);
    std::erase_if(open.triangles, [&](const Triangle& t) { return open.vertices[t[0]].z > 0.95; });
    const ClippedVolume clip = clipped(open, 0.15);
    EXPECT_NEAR(clip.volume, 4.18879, 0.05);
    EXPECT_LT(closure_errors(clip).volume, 1e-13);
}

TEST(ClipByWindingNumber, gives_the_same_bits_for_any_number_of_threads) {
    const TriangleMesh body = posed(make_torus(1, 0.4), 3);
    const ClippedVolume one = clipped(body, 0.17, 1);
    for (int count : {2, 3, 8}) EXPECT_TRUE(same_bits(one, clipped(body, 0.17, count))) << count << " threads";
}

}  // namespace
}  // namespace phyxel
