#include <gtest/gtest.h>

#include "geometry/clipping_shapes.h"
#include "geometry/surface_cut.h"

namespace phyxel {
namespace {

/// A box on the planes of its lattice, but for what is lost by turning and shifting it there and back.
TriangleMesh wobbling_box(int seed, double away) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const Mat3 Q = rotation_about(normalized(random_vector(random)), 3 * random_vector(random).x);
    const Vec3 shift = away * random_vector(random);
    TriangleMesh mesh = make_box({1, 0.8, 0.6});
    for (Vec3& X : mesh.vertices) X = transpose(Q) * ((Q * X + shift) - shift) + Vec3{0.5, 0.4, 0.3};
    return mesh;
}

TEST(Clipping, box_that_wobbles_by_rounding_about_its_planes_keeps_its_volume) {
    for (const double away : {0.0, 1.0, 10.0, 300.0})
        for (int seed = 1; seed <= 25; ++seed) {
            const TriangleMesh mesh = wobbling_box(seed, away);
            const ClippedVolume clip = clip_closed(mesh, 0.1, Threads(2));
            EXPECT_EQ(clip.octants.size(), 480u) << away << " " << seed;
            EXPECT_NEAR(clip.volume, 0.48, 1e-12) << away << " " << seed;
            EXPECT_LE(clip.leak, 1e-13) << away << " " << seed;
            double area = 0;
            for (const SurfacePoint& piece : cut_surface(mesh, 0.1)) area += norm(piece.area);
            EXPECT_NEAR(area, 2 * (0.8 + 0.48 + 0.6), 1e-12) << away << " " << seed;
        }
}

}  // namespace
}  // namespace phyxel
