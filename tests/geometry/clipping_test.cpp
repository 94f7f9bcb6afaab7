#include "geometry/clipping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/clipping_shapes.h"

namespace phyxel {
namespace {

TEST(ClipClosed, volumes_and_first_moments_add_up_to_those_of_the_mesh) {
    const Threads threads(2);
    for (const auto& [name, mesh] : test_bodies())
        for (int pose = 0; pose < 4; ++pose)
            for (double cells : {5.0, 17.0}) {
                const TriangleMesh body = pose == 0 ? mesh : posed(mesh, pose);
                const double pitch = body_size(body) / cells;
                const ClippedVolume clip = clip_closed(body, pitch, threads);
                const VolumeMoments expected = volume_moments(body);
                Vec3 moment;
                double volume = 0;
                for (const Octant& o : clip.octants) {
                    volume += o.volume;
                    moment += o.volume * o.centroid;
                }
                const double size = norm(expected.moment) + expected.volume * body_size(body);
                EXPECT_NEAR(clip.volume, expected.volume, 1e-12 * expected.volume) << name << " pose " << pose;
                EXPECT_NEAR(volume, expected.volume, 1e-12 * expected.volume) << name << " pose " << pose;
                EXPECT_LT(norm(moment - expected.moment), 1e-12 * size) << name << " pose " << pose;
                EXPECT_LT(clip.leak, 1e-13) << name << " pose " << pose;
            }
}

TEST(ClipClosed, boundary_closes_and_spans_the_volume) {
    for (const auto& [name, mesh] : test_bodies())
        for (int pose = 0; pose < 3; ++pose) {
            const TriangleMesh body = pose == 0 ? mesh : posed(mesh, pose);
            const ClippedVolume clip = clip_closed(body, body_size(body) / 13, Threads(1));
            const ClosureErrors errors = closure_errors(clip);
            EXPECT_LT(errors.area, 1e-13) << name << " pose " << pose;
            EXPECT_LT(errors.volume, 1e-12) << name << " pose " << pose;
        }
}

TEST(ClipClosed, a_box_on_octant_planes_is_made_of_whole_octants) {
    for (double pitch : {0.25, 0.1, 1.0 / 3}) {
        const TriangleMesh box = make_box({6 * pitch, 4 * pitch, 2 * pitch});
        const ClippedVolume clip = clip_closed(box, pitch, Threads(1));
        EXPECT_EQ(clip.octants.size(), 48u);
        for (const Octant& o : clip.octants) {
            EXPECT_EQ(o.volume, pitch * pitch * pitch);
            for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(o.centroid[c], (o.index[c] + 0.5) * pitch);
        }
        EXPECT_LT(clip.leak, 1e-15);
    }
}

TEST(ClipClosed, octants_are_sorted_positive_and_hold_their_centroid) {
    const TriangleMesh body = posed(bunny(), 2);
    const double pitch = body_size(body) / 40, whole = pitch * pitch * pitch;
    const ClippedVolume clip = clip_closed(body, pitch, Threads(2));
    EXPECT_TRUE(std::is_sorted(clip.octants.begin(), clip.octants.end(),
                               [](const Octant& a, const Octant& b) { return a.index < b.index; }));
    for (const Octant& o : clip.octants) {
        EXPECT_GT(o.volume, 0);
        EXPECT_LT(o.volume, whole * (1 + 1e-10));
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_GE(o.centroid[c], (o.index[c] - 1e-9) * pitch);
            EXPECT_LE(o.centroid[c], (o.index[c] + 1 + 1e-9) * pitch);
        }
    }
}

TEST(ClipClosed, an_inward_shell_inside_is_a_cavity) {
    const TriangleMesh outer = make_box({2, 2, 2}), inner = make_sphere(0.6);
    const TriangleMesh hollow = posed(joined(outer, inverted(inner)), 1);
    const ClippedVolume clip = clip_closed(hollow, 0.11, Threads(1));
    const double expected = volume_moments(outer).volume - volume_moments(inner).volume;
    EXPECT_NEAR(clip.volume, expected, 1e-12 * expected);
    EXPECT_LT(closure_errors(clip).volume, 1e-12);
}

TEST(ClipClosed, an_open_mesh_leaks) {
    TriangleMesh open = posed(make_sphere(1), 1);
    EXPECT_LT(clip_closed(open, 0.3, Threads(1)).leak, 1e-13);
    open.triangles.pop_back();
    EXPECT_GT(clip_closed(open, 0.3, Threads(1)).leak, 1e-4);
}

TEST(ClipClosed, a_body_inside_out_has_no_octant) {
    EXPECT_TRUE(clip_closed(inverted(make_box({1, 1, 1})), 0.21, Threads(1)).octants.empty());
}

TEST(ClipClosed, a_plate_far_thinner_than_an_octant_keeps_its_volume) {
    for (int pose = 0; pose < 4; ++pose) {
        const TriangleMesh box = make_box({3, 2, 1e-4}), plate = pose == 0 ? box : posed(box, pose);
        const ClippedVolume clip = clip_closed(plate, 0.2, Threads(1));
        EXPECT_NEAR(clip.volume, 6e-4, 6e-16) << "pose " << pose;
    }
}

TEST(ClipClosed, gives_the_same_bits_for_any_number_of_threads) {
    const TriangleMesh body = posed(bunny(), 1);
    const double pitch = body_size(body) / 20;
    const ClippedVolume one = clip_closed(body, pitch, Threads(1));
    for (int count : {2, 3, 8}) {
        const ClippedVolume many = clip_closed(body, pitch, Threads(count));
        EXPECT_TRUE(same_bits(one, many)) << count << " threads";
    }
}

TEST(CutSurface, gives_the_boundary_of_the_clipped_volume) {
    const TriangleMesh body = posed(bunny(), 3);
    const double pitch = body_size(body) / 20;
    ClippedVolume clip = clip_closed(body, pitch, Threads(1));
    const std::size_t pieces = clip.boundary.size();
    clip.boundary = cut_surface(body, pitch);
    EXPECT_EQ(clip.boundary.size(), pieces);
    EXPECT_LT(closure_errors(clip).volume, 1e-12);
    for (const SurfacePoint& p : clip.boundary) ASSERT_LT(p.triangle, body.triangles.size());
}

}  // namespace
}  // namespace phyxel
