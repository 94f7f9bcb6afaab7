#include "geometry/clipping.h"

#include <algorithm>
#include <cmath>

#include "geometry/merged_pieces.h"
#include "geometry/surface_cut.h"

namespace phyxel {
namespace {

/// Signed columns. Every piece of surface stands for the column of solid below it, counted positive where the surface
/// looks up and negative where it looks down. In its own octant the column ends at the piece and contributes
///   V = int (z - z0) dA,   M = int (x, y, (z + z0)/2) (z - z0) dA,   dA = the signed area projected along z,
/// z0 the octant's floor; through the octants below it runs whole. A closed surface leaves no column below itself.
/// Coordinates are relative to the octant's centre, which keeps the rounding that of one octant.
struct Column {
    double volume = 0;
    Vec3 moment;
    double area = 0, area_x = 0, area_y = 0;  ///< of the pieces: int (1, x, y) dA
    bool cut = false;
};

void add_piece(Column& column, const ConvexPolygon& piece, const Vec3& centre, double pitch) {
    column.cut = true;
    const Vec3 p = piece.points[0] - centre;
    for (std::size_t c = 1; c + 1 < piece.size; ++c) {
        const Vec3 q = piece.points[c] - centre, r = piece.points[c + 1] - centre;
        const double area = 0.5 * ((q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y));
        // The middles of a triangle's edges integrate quadratic functions exactly.
        for (const Vec3& m : {0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p)}) {
            const double w = area / 3, height = m.z + 0.5 * pitch;
            column.volume += w * height;
            column.moment += w * height * Vec3{m.x, m.y, 0.5 * (m.z - 0.5 * pitch)};
            column.area_x += w * m.x;
            column.area_y += w * m.y;
        }
        column.area += area;
    }
}

/// Octants below this fraction of a whole one give what they hold to their largest neighbour, unless it is mere
/// rounding; those within rounding of a whole one are whole.
constexpr double sliver_fraction = 1e-11, rounding_fraction = 1e-13;

struct Sliver {
    std::array<int, 3> index;
    double volume;
    Vec3 moment;  ///< about the octant's centre
};

/// What one strip of octants, all those of one i, gives.
struct Strip {
    std::vector<Octant> octants;
    std::vector<Sliver> slivers;
    std::vector<SurfacePoint> boundary;
    double leak = 0;
};

Vec3 octant_centre(const std::array<int, 3>& index, double pitch) {
    return {(index[0] + 0.5) * pitch, (index[1] + 0.5) * pitch, (index[2] + 0.5) * pitch};
}

/// Stores the octant; its centroid is kept inside it against the rounding of nearly empty ones.
void add_octant(Strip& strip, const std::array<int, 3>& index, double volume, const Vec3& moment, double pitch) {
    const double whole = pitch * pitch * pitch;
    if (std::abs(volume) < rounding_fraction * whole) return;
    if (volume < sliver_fraction * whole) {
        strip.slivers.push_back({index, volume, moment});
        return;
    }
    if (std::abs(volume - whole) < rounding_fraction * whole) {
        strip.octants.push_back({index, whole, octant_centre(index, pitch)});
        return;
    }
    Vec3 offset = moment / volume;
    for (std::size_t c = 0; c < 3; ++c) offset[c] = std::clamp(offset[c], -0.5 * pitch, 0.5 * pitch);
    strip.octants.push_back({index, volume, octant_centre(index, pitch) + offset});
}

/// Sums one column of octants from the top down.
void finish_column(const Column* column, int i, int j, LatticeRange k_range, double pitch, Strip& strip) {
    const std::size_t height = static_cast<std::size_t>(k_range.last - k_range.first) + 1;
    const std::size_t first_octant = strip.octants.size();
    const double face = pitch * pitch;
    double area = 0, area_x = 0, area_y = 0;
    for (std::size_t k = height; k-- > 0;) {
        const Column& c = column[k];
        const std::array<int, 3> index{i, j, k_range.first + static_cast<int>(k)};
        if (c.cut) {
            const Vec3 moment = c.moment + Vec3{area_x * pitch, area_y * pitch, 0};
            add_octant(strip, index, c.volume + area * pitch, moment, pitch);
        } else {
            // No surface here: as often inside as a whole number says.
            const double covered = std::round(area / face);
            if (std::abs(area / face - covered) < 1e-9) add_octant(strip, index, covered * face * pitch, {}, pitch);
            else add_octant(strip, index, area * pitch, {area_x * pitch, area_y * pitch, 0}, pitch);
        }
        area += c.area;
        area_x += c.area_x;
        area_y += c.area_y;
    }
    std::reverse(strip.octants.begin() + static_cast<std::ptrdiff_t>(first_octant), strip.octants.end());
    strip.leak = std::max(strip.leak, std::abs(area) / face);
}

/// Rows and layers that the triangles of a strip reach.
std::array<LatticeRange, 2> strip_extent(const TriangleMesh& mesh, const StripTriangles& strips, std::size_t s,
                                         double pitch) {
    std::array<LatticeRange, 2> extent{};
    ConvexPolygon triangle;
    for (std::size_t n = strips.offset[s]; n < strips.offset[s + 1]; ++n) {
        set_triangle(triangle, mesh, strips.triangles[n]);
        const std::array<LatticeRange, 2> reach{lattice_range<1>(triangle, pitch), lattice_range<2>(triangle, pitch)};
        for (std::size_t c = 0; c < 2; ++c) {
            const bool start = n == strips.offset[s];
            extent[c].first = start ? reach[c].first : std::min(extent[c].first, reach[c].first);
            extent[c].last = start ? reach[c].last : std::max(extent[c].last, reach[c].last);
        }
    }
    return extent;
}

Strip clip_strip(const TriangleMesh& mesh, const StripTriangles& strips, std::size_t s, double pitch) {
    Strip strip;
    if (strips.offset[s] == strips.offset[s + 1]) return strip;
    const int i = strips.first + static_cast<int>(s);
    const auto [rows, layers] = strip_extent(mesh, strips, s, pitch);
    const auto width = static_cast<std::size_t>(rows.last - rows.first) + 1;
    const auto height = static_cast<std::size_t>(layers.last - layers.first) + 1;

    // Every piece into its octant.
    std::vector<Column> columns(width * height);
    visit_strip(mesh, strips, s, pitch, [&](int j, int k, const ConvexPolygon& piece, std::uint32_t triangle) {
        const std::size_t column = static_cast<std::size_t>(j - rows.first) * height;
        const std::size_t octant = column + static_cast<std::size_t>(k - layers.first);
        add_piece(columns[octant], piece, octant_centre({i, j, k}, pitch), pitch);
        const SurfacePoint point = surface_point(piece, triangle);
        if (norm_squared(point.area) > 0) strip.boundary.push_back(point);
    });

    // Columns, from the top down.
    for (std::size_t j = 0; j < width; ++j)
        finish_column(&columns[j * height], i, rows.first + static_cast<int>(j), layers, pitch, strip);
    return strip;
}

/// Volume and first moment of a sliver go to its largest face neighbour; without one it is left out.
void give_away(const Sliver& sliver, std::vector<Octant>& octants, double pitch) {
    const auto find = [&](const std::array<int, 3>& index) -> Octant* {
        const auto found = std::lower_bound(octants.begin(), octants.end(), index,
                                            [](const Octant& o, const std::array<int, 3>& x) { return o.index < x; });
        return found != octants.end() && found->index == index ? &*found : nullptr;
    };
    Octant* largest = nullptr;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int side : {-1, 1}) {
            std::array<int, 3> index = sliver.index;
            index[axis] += side;
            Octant* neighbor = find(index);
            if (neighbor && (!largest || neighbor->volume > largest->volume)) largest = neighbor;
        }
    if (!largest) return;
    const Vec3 arm = octant_centre(sliver.index, pitch) - largest->centroid;
    largest->volume += sliver.volume;
    largest->centroid += (sliver.moment + sliver.volume * arm) / largest->volume;
}

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

ClippedVolume clip_closed(const TriangleMesh& original, double pitch, const Threads& threads) {
    const TriangleMesh mesh = snapped_to_planes(original, pitch);

    // Strips of octants are independent: each sums its own pieces in the order of the triangles.
    const StripTriangles triangles(mesh, pitch);
    std::vector<Strip> strips(triangles.strips());
    threads.for_each(strips.size(), 1, [&](std::size_t s) { strips[s] = clip_strip(mesh, triangles, s, pitch); });

    ClippedVolume clip;
    clip.pitch = pitch;
    for (Strip& strip : strips) {
        append(clip.octants, strip.octants);
        append(clip.boundary, strip.boundary);
        clip.leak = std::max(clip.leak, strip.leak);
        strip.octants = {};
        strip.boundary = {};
    }
    for (const Strip& strip : strips)
        for (const Sliver& sliver : strip.slivers) give_away(sliver, clip.octants, pitch);
    clip.boundary = merge_coplanar(clip.boundary, mesh, pitch);
    clip.volume = threads.sum(clip.octants.size(), 1024, [&](std::size_t o) { return clip.octants[o].volume; });
    return clip;
}

}  // namespace phyxel
