#include <algorithm>
#include <cmath>

#include "geometry/sub_voxels.h"
#include "geometry/surface_cut.h"

namespace phyxel {
namespace {

using sub_voxel::Mask;

/// A surface met by a line along z: all sub-voxels of the line below `height` gain `sign`, +1 where the surface looks
/// up. Line and height count sub-voxels from the grid's corner.
struct Crossing {
    int line, height, sign;
    friend bool operator<(const Crossing& a, const Crossing& b) {
        return a.line != b.line ? a.line < b.line : a.height < b.height;
    }
};

/// First sub-voxel along an axis, counted from the grid's corner, whose sampled point is not below `coordinate`.
int first_sample(const OctantGrid& grid, std::size_t axis, double coordinate) {
    const double voxel = grid.pitch / sub_voxel::per_edge;
    const double corner = sub_voxel::per_edge * static_cast<double>(grid.first[axis]);
    return static_cast<int>(std::ceil(coordinate / voxel - corner - 0.5 - sub_voxel::sample_shift[axis]));
}

double sample_coordinate(const OctantGrid& grid, std::size_t axis, int sample) {
    const double voxel = grid.pitch / sub_voxel::per_edge;
    const double corner = sub_voxel::per_edge * static_cast<double>(grid.first[axis]);
    return (corner + sample + 0.5 + sub_voxel::sample_shift[axis]) * voxel;
}

/// Where a triangle meets the lines of the plane x = X. The two edges from below X to X or above give the ends of a
/// segment; an end depends on its edge alone and lines y1 <= Y < y2 are met, so that the segments of a closed surface
/// join without gap or overlap and every line leaves as often as it enters, whatever is rounded.
void add_crossings(const OctantGrid& grid, const ConvexPolygon& triangle, double X, std::vector<Crossing>& crossings) {
    Vec3 rising, falling;
    int ends = 0;
    for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 &p = triangle.points[e], &q = triangle.points[(e + 1) % 3];
        const bool up = p.x < X && q.x >= X, down = q.x < X && p.x >= X;
        if (!up && !down) continue;
        const Vec3 &low = up ? p : q, &high = up ? q : p;
        (up ? rising : falling) = low + (high - low) * ((X - low.x) / (high.x - low.x));
        ++ends;
    }
    if (ends != 2 || rising.y == falling.y) return;

    // Counter-clockwise from above, the edge that leads upward in x has the lower y.
    const bool looks_up = rising.y < falling.y;
    const Vec3 &left = looks_up ? rising : falling, &right = looks_up ? falling : rising;
    const int last = first_sample(grid, 1, right.y);
    for (int line = first_sample(grid, 1, left.y); line < last; ++line) {
        const double t = (sample_coordinate(grid, 1, line) - left.y) / (right.y - left.y);
        const double z = left.z + std::clamp(t, 0.0, 1.0) * (right.z - left.z);
        crossings.push_back({line, first_sample(grid, 2, z), looks_up ? 1 : -1});
    }
}

/// Sets the sub-voxels [from, to) of a line along z.
void fill_line(SubVoxels& voxels, int i, int x, int line, int from, int to) {
    const int edge = sub_voxel::per_edge;
    const int j = line / edge, y = line % edge;
    Mask* column = &voxels.masks[voxels.grid.at({i, voxels.grid.first[1] + j, voxels.grid.first[2]})];
    while (from < to) {
        const int k = from / edge, end = std::min(to, (k + 1) * edge);
        for (; from < end; ++from) column[k] |= Mask{1} << sub_voxel::bit(x, y, from % edge);
    }
}

/// Walks down every line and fills where more surface looks up than down above. Returns whether all lines close.
bool fill_plane(SubVoxels& voxels, int i, int x, std::vector<Crossing>& crossings) {
    std::sort(crossings.begin(), crossings.end());
    bool closed = true;
    int winding = 0;
    for (std::size_t c = crossings.size(); c-- > 0;) {
        winding += crossings[c].sign;
        if (c > 0 && crossings[c - 1].line == crossings[c].line) {
            if (winding > 0) fill_line(voxels, i, x, crossings[c].line, crossings[c - 1].height, crossings[c].height);
        } else {
            closed = closed && winding == 0;
            winding = 0;
        }
    }
    return closed;
}

}  // namespace

std::optional<SubVoxels> sub_voxels_by_columns(const TriangleMesh& mesh, double pitch, const Threads& threads) {
    SubVoxels voxels{OctantGrid(mesh, pitch), {}};
    const OctantGrid& grid = voxels.grid;
    voxels.masks.assign(grid.size(), sub_voxel::none);

    const StripTriangles strips(mesh, pitch);
    std::vector<std::uint8_t> closed(strips.strips());
    threads.for_each(strips.strips(), 1, [&](std::size_t s) {
        const int i = strips.first + static_cast<int>(s);
        std::vector<Crossing> crossings;
        ConvexPolygon triangle;
        bool strip_closed = true;
        for (int x = 0; x < sub_voxel::per_edge; ++x) {
            crossings.clear();
            const double X = sample_coordinate(grid, 0, sub_voxel::per_edge * (i - grid.first[0]) + x);
            for (std::size_t n = strips.offset[s]; n < strips.offset[s + 1]; ++n) {
                set_triangle(triangle, mesh, strips.triangles[n]);
                add_crossings(grid, triangle, X, crossings);
            }
            strip_closed = fill_plane(voxels, i, x, crossings) && strip_closed;
        }
        closed[s] = strip_closed;
    });
    if (std::find(closed.begin(), closed.end(), 0) != closed.end()) return std::nullopt;
    return voxels;
}

}  // namespace phyxel
