#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "geometry/clipping.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

/// Triangles cut along the planes of a lattice: by the x planes first, each strip by the y planes, each of its pieces
/// by the z planes. A cut point depends on the ends of its edge and on the plane alone, never on the direction in which
/// the edge is walked: pieces on both sides of a plane or of an edge share points that are equal bit by bit, so that a
/// closed surface stays closed.

namespace phyxel {

/// A small convex polygon; a triangle cut by six planes has at most nine corners.
struct ConvexPolygon {
    std::size_t size = 0;
    std::array<Vec3, 16> points;

    void add(const Vec3& point) {
        assert(size < points.size());
        points[size++] = point;
    }
};

/// The lattice intervals [k, k + 1) pitch from `first` to `last` that a piece spans. One that merely ends on a plane
/// does not reach the interval above; one that lies in a plane belongs to the interval above.
struct LatticeRange {
    int first, last;
};

inline int lattice_index(double coordinate, double pitch) {
    int k = static_cast<int>(std::floor(coordinate / pitch));
    // The quotient may round across the plane.
    if (coordinate < k * pitch) --k;
    if (coordinate >= (k + 1) * pitch) ++k;
    return k;
}

inline LatticeRange lattice_range(double lower, double upper, double pitch) {
    LatticeRange range{lattice_index(lower, pitch), lattice_index(upper, pitch)};
    if (range.last > range.first && upper == range.last * pitch) --range.last;
    return range;
}

template <std::size_t Axis>
LatticeRange lattice_range(const ConvexPolygon& polygon, double pitch) {
    double lower = polygon.points[0][Axis], upper = lower;
    for (std::size_t p = 1; p < polygon.size; ++p) {
        lower = std::min(lower, polygon.points[p][Axis]);
        upper = std::max(upper, polygon.points[p][Axis]);
    }
    return lattice_range(lower, upper, pitch);
}

/// Where the edge from `low` to `high` (low[Axis] < plane < high[Axis]) meets the plane.
template <std::size_t Axis>
Vec3 cut_edge(const Vec3& low, const Vec3& high, double plane) {
    Vec3 point = low + (high - low) * ((plane - low[Axis]) / (high[Axis] - low[Axis]));
    point[Axis] = plane;
    return point;
}

/// The part of `polygon` with lower <= x[Axis] <= upper; empty when it is less than a triangle.
template <std::size_t Axis>
void clip_to_slab(const ConvexPolygon& polygon, double lower, double upper, ConvexPolygon& part) {
    part.size = 0;
    for (std::size_t e = 0; e < polygon.size; ++e) {
        const Vec3& p = polygon.points[e];
        const Vec3& q = polygon.points[e + 1 == polygon.size ? 0 : e + 1];
        if (p[Axis] >= lower && p[Axis] <= upper) part.add(p);
        if (p[Axis] < q[Axis]) {
            if (p[Axis] < lower && q[Axis] > lower) part.add(cut_edge<Axis>(p, q, lower));
            if (p[Axis] < upper && q[Axis] > upper) part.add(cut_edge<Axis>(p, q, upper));
        } else {
            if (q[Axis] < upper && p[Axis] > upper) part.add(cut_edge<Axis>(q, p, upper));
            if (q[Axis] < lower && p[Axis] > lower) part.add(cut_edge<Axis>(q, p, lower));
        }
    }
    if (part.size < 3) part.size = 0;
}

/// Calls `visit(k, part)` for every part of `polygon` between two neighbouring planes of an axis.
template <std::size_t Axis, class Visit>
void visit_slabs(const ConvexPolygon& polygon, double pitch, Visit&& visit) {
    const LatticeRange range = lattice_range<Axis>(polygon, pitch);
    if (range.first == range.last) return visit(range.first, polygon);
    ConvexPolygon part;
    for (int k = range.first; k <= range.last; ++k) {
        clip_to_slab<Axis>(polygon, k * pitch, (k + 1) * pitch, part);
        if (part.size > 0) visit(k, part);
    }
}

/// Calls `visit(j, k, piece)` for every piece of a strip that lies between two x planes.
template <class Visit>
void visit_strip_pieces(const ConvexPolygon& strip, double pitch, Visit&& visit) {
    visit_slabs<1>(strip, pitch, [&](int j, const ConvexPolygon& row) {
        visit_slabs<2>(row, pitch, [&](int k, const ConvexPolygon& piece) { visit(j, k, piece); });
    });
}

/// Calls `visit(i, j, k, piece)` for every piece of a triangle.
template <class Visit>
void visit_pieces(const ConvexPolygon& triangle, double pitch, Visit&& visit) {
    visit_slabs<0>(triangle, pitch, [&](int i, const ConvexPolygon& strip) {
        visit_strip_pieces(strip, pitch, [&](int j, int k, const ConvexPolygon& piece) { visit(i, j, k, piece); });
    });
}

inline void set_triangle(ConvexPolygon& polygon, const TriangleMesh& mesh, std::size_t triangle) {
    polygon.size = 3;
    for (std::size_t c = 0; c < 3; ++c) polygon.points[c] = mesh.vertices[mesh.triangles[triangle][c]];
}

/// The mesh with every coordinate that is within rounding of a plane moved onto it, shared vertices alike. A face that
/// should lie in a plane but wobbles about it would be cut along lines that rounding alone decides, and its pieces
/// would overlap: a box that was turned, on its own lattice, lost a thousandth of its volume.
TriangleMesh snapped_to_planes(const TriangleMesh& mesh, double pitch);

/// Centroid and area vector of a piece.
SurfacePoint surface_point(const ConvexPolygon& piece, std::uint32_t triangle);

/// Triangles sorted by the lattice intervals of the x axis that they reach: one list for each strip of octants, so that
/// strips can be worked on side by side.
struct StripTriangles {
    StripTriangles(const TriangleMesh& mesh, double pitch);

    int first = 0;                         ///< i of strip 0
    std::vector<std::size_t> offset;       ///< [strips + 1] into `triangles`
    std::vector<std::uint32_t> triangles;  ///< ascending within a strip

    std::size_t strips() const { return offset.size() - 1; }
};

/// Calls `visit(j, k, piece, triangle)` for every piece in strip `s`, triangle by triangle.
template <class Visit>
void visit_strip(const TriangleMesh& mesh, const StripTriangles& strips, std::size_t s, double pitch, Visit&& visit) {
    const int i = strips.first + static_cast<int>(s);
    ConvexPolygon triangle, strip;
    for (std::size_t n = strips.offset[s]; n < strips.offset[s + 1]; ++n) {
        const std::uint32_t t = strips.triangles[n];
        set_triangle(triangle, mesh, t);
        clip_to_slab<0>(triangle, i * pitch, (i + 1) * pitch, strip);
        if (strip.size == 0) continue;
        visit_strip_pieces(strip, pitch, [&](int j, int k, const ConvexPolygon& piece) { visit(j, k, piece, t); });
    }
}

}  // namespace phyxel
