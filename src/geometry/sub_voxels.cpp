#include "geometry/sub_voxels.h"

#include <algorithm>
#include <cmath>

#include "geometry/bvh.h"
#include "geometry/surface_cut.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

using sub_voxel::Mask;

Vec3 sample_point(const OctantGrid& grid, const std::array<int, 3>& index, const Vec3& offset) {
    return grid.corner(index) + grid.pitch / sub_voxel::per_edge * (offset + sub_voxel::sample_shift);
}

double sample(const OctantGrid& grid, const std::array<int, 3>& index, const WindingNumber& winding, int bit) {
    return winding(sample_point(grid, index, {bit / 16 + 0.5, bit / 4 % 4 + 0.5, bit % 4 + 0.5}));
}

/// The connected sub-voxels of `region` that hold its first one.
Mask first_connected(Mask region) {
    Mask part = region & (~region + 1), previous = sub_voxel::none;
    while (part != previous) {
        previous = part;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (int step : {-1, 1}) part |= sub_voxel::with_neighbor(previous, sub_voxel::none, axis, step) & region;
    }
    return part;
}

/// Whether all sub-voxels of a region without surface lie on the side of its first and last one: the winding number is
/// smooth there, and far from 1/2 at both.
bool decided_alike(double first, double last) {
    return std::abs(first - 0.5) > 0.25 && std::abs(last - 0.5) > 0.25 && (first > 0.5) == (last > 0.5);
}

/// Samples the sub-voxels that hold surface one by one, and of each region between them the ends, or all where the ends
/// do not decide.
Mask sample_octant(const OctantGrid& grid, const std::array<int, 3>& index, const WindingNumber& winding,
                   Mask with_surface) {
    Mask inside = sub_voxel::none, single = with_surface;
    for (Mask rest = ~with_surface; rest;) {
        const Mask region = first_connected(rest);
        rest &= ~region;
        const double first = sample(grid, index, winding, std::countr_zero(region));
        const double last = sample(grid, index, winding, 63 - std::countl_zero(region));
        if (!decided_alike(first, last)) single |= region;
        else if (first > 0.5) inside |= region;
    }
    for (Mask rest = single; rest; rest &= rest - 1)
        if (sample(grid, index, winding, std::countr_zero(rest)) > 0.5) inside |= rest & (~rest + 1);
    return inside;
}

/// Whether the solid begins or ends between this octant and a neighbour although no surface crosses either.
bool changes_without_surface(const SubVoxels& voxels, const std::vector<Mask>& surface, std::size_t octant) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t neighbor : {octant - voxels.grid.stride(axis), octant + voxels.grid.stride(axis)})
            if (!surface[neighbor] && voxels.masks[neighbor] != voxels.masks[octant]) return true;
    return false;
}

/// The sub-voxels of every octant that hold a piece of the surface; a piece within a plane belongs to the one above.
std::vector<Mask> surface_sub_voxels(const TriangleMesh& mesh, const OctantGrid& grid, const Threads& threads) {
    constexpr int edge = sub_voxel::per_edge;
    std::vector<Mask> masks(grid.size());
    const StripTriangles strips(mesh, grid.pitch);
    threads.for_each(strips.strips(), 1, [&](std::size_t s) {
        const int i = strips.first + static_cast<int>(s);
        visit_strip(mesh, strips, s, grid.pitch, [&](int j, int k, const ConvexPolygon& piece, std::uint32_t) {
            Mask& mask = masks[grid.at({i, j, k})];
            visit_pieces(piece, grid.pitch / edge, [&](int x, int y, int z, const ConvexPolygon&) {
                // A cut point may be rounded across the octant's face.
                const auto within = [&](int fine, int octant) { return std::clamp(fine - edge * octant, 0, edge - 1); };
                mask |= Mask{1} << sub_voxel::bit(within(x, i), within(y, j), within(z, k));
            });
        });
    });
    return masks;
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
    const std::vector<Mask> surface = surface_sub_voxels(mesh, grid, threads);

    // Away from the surface one sample decides; next to it all 64.
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>& index, std::size_t octant) {
            if (surface[octant]) voxels.masks[octant] = sample_octant(grid, index, winding, surface[octant]);
            else if (winding.inside(sample_point(grid, index, {2, 2, 2}))) voxels.masks[octant] = sub_voxel::all;
        });
    });

    // Where the surface has a hole.
    std::vector<std::uint8_t> open(grid.size());
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>&, std::size_t octant) {
            open[octant] = !surface[octant] && changes_without_surface(voxels, surface, octant);
        });
    });
    grid.for_planes(threads, [&](int i) {
        grid.visit_plane(i, [&](const std::array<int, 3>& index, std::size_t octant) {
            if (open[octant]) voxels.masks[octant] = sample_octant(grid, index, winding, sub_voxel::all);
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
