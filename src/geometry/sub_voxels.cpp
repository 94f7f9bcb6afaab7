#include "geometry/sub_voxels.h"

#include "geometry/bvh.h"
#include "geometry/surface_cut.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

using sub_voxel::Mask;

Vec3 sample_point(const OctantGrid& grid, const std::array<int, 3>& index, const Vec3& offset) {
    return grid.corner(index) + grid.pitch / sub_voxel::per_edge * (offset + sub_voxel::sample_shift);
}

Mask sample_octant(const OctantGrid& grid, const std::array<int, 3>& index, const WindingNumber& winding) {
    Mask mask = sub_voxel::none;
    for (int x = 0; x < sub_voxel::per_edge; ++x)
        for (int y = 0; y < sub_voxel::per_edge; ++y)
            for (int z = 0; z < sub_voxel::per_edge; ++z)
                if (winding.inside(sample_point(grid, index, {x + 0.5, y + 0.5, z + 0.5})))
                    mask |= Mask{1} << sub_voxel::bit(x, y, z);
    return mask;
}

/// Whether the solid begins or ends between this octant and a neighbour although no surface crosses either.
bool changes_without_surface(const SubVoxels& voxels, const std::vector<std::uint8_t>& crossed, std::size_t octant) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t neighbor : {octant - voxels.grid.stride(axis), octant + voxels.grid.stride(axis)})
            if (!crossed[neighbor] && voxels.masks[neighbor] != voxels.masks[octant]) return true;
    return false;
}

/// Marks the octants that hold a piece of the surface; a piece within a plane belongs to the octant above.
std::vector<std::uint8_t> crossed_octants(const TriangleMesh& mesh, const OctantGrid& grid, const Threads& threads) {
    std::vector<std::uint8_t> crossed(grid.size());
    const StripTriangles strips(mesh, grid.pitch);
    threads.for_each(strips.strips(), 1, [&](std::size_t s) {
        const int i = strips.first + static_cast<int>(s);
        visit_strip(mesh, strips, s, grid.pitch, [&](int j, int k, const ConvexPolygon&, std::uint32_t) {
            crossed[grid.at({i, j, k})] = 1;
        });
    });
    return crossed;
}

}  // namespace

OctantGrid::OctantGrid(const TriangleMesh& mesh, double edge) : pitch(edge) {
    const Bounds box = bounding_box(mesh);
    for (std::size_t c = 0; c < 3; ++c) {
        first[c] = lattice_index(box.lower[c], pitch) - 1;
        extent[c] = lattice_index(box.upper[c], pitch) + 2 - first[c];
    }
}

SubVoxels sub_voxels_by_winding_number(const TriangleMesh& mesh, const WindingNumber& winding, double pitch,
                                       const Threads& threads) {
    SubVoxels voxels{OctantGrid(mesh, pitch), {}};
    const OctantGrid& grid = voxels.grid;
    voxels.masks.assign(grid.size(), sub_voxel::none);
    const std::vector<std::uint8_t> crossed = crossed_octants(mesh, grid, threads);

    // Away from the surface one sample decides; next to it all 64.
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>& index, std::size_t octant) {
            if (crossed[octant]) voxels.masks[octant] = sample_octant(grid, index, winding);
            else if (winding.inside(sample_point(grid, index, {2, 2, 2}))) voxels.masks[octant] = sub_voxel::all;
        });
    });

    // Where the surface has a hole.
    std::vector<std::uint8_t> open(grid.size());
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>&, std::size_t octant) {
            open[octant] = !crossed[octant] && changes_without_surface(voxels, crossed, octant);
        });
    });
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>& index, std::size_t octant) {
            if (open[octant]) voxels.masks[octant] = sample_octant(grid, index, winding);
        });
    });
    return voxels;
}

SubVoxels make_sub_voxels(const TriangleMesh& mesh, const WindingNumber& winding, double pitch,
                          const Threads& threads) {
    std::optional<SubVoxels> closed = sub_voxels_by_columns(mesh, pitch, threads);
    return closed ? std::move(*closed) : sub_voxels_by_winding_number(mesh, winding, pitch, threads);
}

}  // namespace phyxel
