#include "geometry/clipping.h"
#include "geometry/sub_voxels.h"

namespace phyxel {
namespace {

using sub_voxel::Mask;

/// The faces of one octant's sub-voxels that look along `axis`, up or down, onto an empty one: merged to one point at
/// their mean. All have the same area, so that the point is exact for linear fields.
void add_exposed_faces(const SubVoxels& voxels, const std::array<int, 3>& index, std::size_t octant, std::size_t axis,
                       int step, std::vector<SurfacePoint>& boundary) {
    const OctantGrid& grid = voxels.grid;
    const std::size_t stride = grid.stride(axis);
    const Mask mask = voxels.masks[octant], next = voxels.masks[step > 0 ? octant + stride : octant - stride];
    const Mask exposed = mask & ~sub_voxel::with_neighbor(mask, next, axis, step);
    if (exposed == sub_voxel::none) return;
    SurfacePoint point;
    point.position = grid.corner(index) + grid.pitch * sub_voxel::centroid(exposed);
    point.position[axis] += step * 0.5 / sub_voxel::per_edge * grid.pitch;
    const double face = grid.pitch * grid.pitch / (sub_voxel::per_edge * sub_voxel::per_edge);
    point.area[axis] = step * std::popcount(exposed) * face;
    boundary.push_back(point);
}

/// What one plane of octants adds to the clip.
struct OctantPlane {
    std::vector<Octant> octants;
    std::vector<SurfacePoint> boundary;
};

OctantPlane collect_plane(const SubVoxels& voxels, int i) {
    const OctantGrid& grid = voxels.grid;
    const double whole = grid.pitch * grid.pitch * grid.pitch;
    OctantPlane plane;
    grid.visit_plane(i, [&](const std::array<int, 3>& index, std::size_t octant) {
        const Mask mask = voxels.masks[octant];
        if (mask == sub_voxel::none) return;
        const double volume = whole * std::popcount(mask) / 64;
        plane.octants.push_back({index, volume, grid.corner(index) + grid.pitch * sub_voxel::centroid(mask)});
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (int step : {-1, 1}) add_exposed_faces(voxels, index, octant, axis, step, plane.boundary);
    });
    return plane;
}

}  // namespace

ClippedVolume clip_by_winding_number(const TriangleMesh& mesh, const WindingNumber& winding, double pitch,
                                     const Threads& threads) {
    const auto shared = std::make_shared<const SubVoxels>(make_sub_voxels(mesh, winding, pitch, threads));
    const SubVoxels& voxels = *shared;
    const int first = voxels.grid.first[0];
    std::vector<OctantPlane> planes(static_cast<std::size_t>(voxels.grid.extent[0]));
    voxels.grid.for_planes(threads,
                           [&](int i) { planes[static_cast<std::size_t>(i - first)] = collect_plane(voxels, i); });

    ClippedVolume clip;
    clip.pitch = pitch;
    clip.sub_voxels = shared;
    for (const OctantPlane& plane : planes) {
        clip.octants.insert(clip.octants.end(), plane.octants.begin(), plane.octants.end());
        clip.boundary.insert(clip.boundary.end(), plane.boundary.begin(), plane.boundary.end());
    }
    clip.volume = threads.sum(clip.octants.size(), 1024, [&](std::size_t o) { return clip.octants[o].volume; });
    return clip;
}

}  // namespace phyxel
