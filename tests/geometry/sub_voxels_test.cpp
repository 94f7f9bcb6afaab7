#include "geometry/sub_voxels.h"

#include <gtest/gtest.h>

#include "geometry/clipping_shapes.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

TEST(SubVoxels, columns_and_winding_number_agree_on_closed_surfaces) {
    for (const auto& [name, mesh] : test_bodies()) {
        const TriangleMesh body = posed(mesh, 1);
        const double pitch = body_size(body) / 7;
        const auto columns = sub_voxels_by_columns(body, pitch, Threads(2));
        const SubVoxels winding = sub_voxels_by_winding_number(body, WindingNumber(body), pitch, Threads(2));
        ASSERT_TRUE(columns.has_value()) << name;
        EXPECT_EQ(columns->masks, winding.masks) << name;
    }
}

TEST(SubVoxels, columns_of_a_closed_surface_close_even_through_its_edges_and_corners) {
    // Lines at the sampled coordinates run exactly through the edges and corners of these boxes.
    const double pitch = 0.5, voxel = pitch / 4;
    for (double shift : {0.0, 0.5, 0.25}) {
        const Vec3 offset = voxel * (Vec3{shift, shift, shift} + sub_voxel::sample_shift);
        const TriangleMesh box = transformed(make_box({1, 1, 1}), Mat3::identity(), offset);
        const auto voxels = sub_voxels_by_columns(box, pitch, Threads(1));
        ASSERT_TRUE(voxels.has_value()) << shift;
        int count = 0;
        for (sub_voxel::Mask mask : voxels->masks) count += std::popcount(mask);
        EXPECT_EQ(count, 512) << shift;
    }
}

TEST(SubVoxels, columns_refuse_an_open_surface) {
    TriangleMesh open = posed(make_box({1, 1, 1}), 1);
    open.triangles.resize(open.triangles.size() * 11 / 12);
    EXPECT_FALSE(sub_voxels_by_columns(open, 0.2, Threads(1)).has_value());
}

}  // namespace
}  // namespace phyxel
