#include <algorithm>
#include <optional>

#include "geometry/mesh_measure.h"
#include "geometry/mesh_repair.h"
#include "geometry/mesh_topology.h"
#include "geometry/winding_number.h"

namespace phyxel {

namespace {

void turn(Triangle& t) { std::swap(t[1], t[2]); }

bool agree(const TriangleMesh& mesh, HalfEdge g, HalfEdge h) {
    return origin_of(mesh, g) == target_of(mesh, h) && target_of(mesh, g) == origin_of(mesh, h);
}

/// Turns triangles so that the two of every edge agree, as far as the surface has two sides. Returns the piece of every
/// triangle: connected across edges of two triangles.
std::vector<std::uint32_t> orient_pieces(TriangleMesh& mesh, const EdgeTable& edges, MeshReport& report) {
    // The neighbours of every triangle across edges of two, and whether they agree now
    const std::size_t n = mesh.triangles.size();
    struct Neighbour {
        std::uint32_t triangle = UINT32_MAX;
        bool agrees = true;
    };
    std::vector<std::array<Neighbour, 3>> neighbours(n);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto sides = edges.sides(e);
        if (sides.size() != 2) continue;
        const bool now = agree(mesh, sides[0], sides[1]);
        neighbours[sides[0] / 3][sides[0] % 3] = {sides[1] / 3, now};
        neighbours[sides[1] / 3][sides[1] % 3] = {sides[0] / 3, now};
    }

    // Spread from the first triangle of each piece; the smaller part is turned
    std::vector<std::uint32_t> piece(n, UINT32_MAX), members;
    std::vector<char> turned(n, 0);
    std::uint32_t pieces = 0;
    for (std::uint32_t seed = 0; seed < n; ++seed) {
        if (piece[seed] != UINT32_MAX) continue;
        members.assign(1, seed);
        piece[seed] = pieces;
        std::size_t turns = 0;
        for (std::size_t i = 0; i < members.size(); ++i)
            for (const Neighbour& next : neighbours[members[i]]) {
                if (next.triangle == UINT32_MAX || piece[next.triangle] != UINT32_MAX) continue;
                piece[next.triangle] = pieces;
                turned[next.triangle] = turned[members[i]] != !next.agrees;
                turns += turned[next.triangle];
                members.push_back(next.triangle);
            }
        const bool turn_the_others = 2 * turns > members.size();
        for (const std::uint32_t t : members)
            if (turned[t] != turn_the_others) {
                turn(mesh.triangles[t]);
                ++report.flipped_triangles;
            }
        ++pieces;
    }
    return piece;
}

/// A part of the surface whose sense is decided as a whole: a piece, or several that only together are closed.
struct Shell {
    std::vector<std::uint32_t> triangles;  ///< of the whole mesh
    bool closed = true;                    ///< at every edge, as many triangles run one way as the other
    Bounds box;
    double volume = 0;
    bool inside_out = false;
};

/// Net direction of an edge's triangles of one group: 0 where the group is closed across the edge.
template <class Group>
int imbalance(const TriangleMesh& mesh, std::span<const HalfEdge> sides, Group&& in_group) {
    int net = 0;
    for (const HalfEdge h : sides)
        if (in_group(h)) net += origin_of(mesh, h) < target_of(mesh, h) ? 1 : -1;
    return net;
}

std::vector<Shell> find_shells(const TriangleMesh& mesh, const EdgeTable& edges,
                               const std::vector<std::uint32_t>& piece) {
    // Pieces that are not closed across an edge of many triangles belong together
    DisjointSets sets(mesh.triangles.size() + 1);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto sides = edges.sides(e);
        if (sides.size() < 3) continue;
        std::optional<std::uint32_t> first;
        for (const HalfEdge h : sides) {
            const std::uint32_t own = piece[h / 3];
            if (imbalance(mesh, sides, [&](HalfEdge g) { return piece[g / 3] == own; }) == 0) continue;
            if (first) sets.unite(*first, own);
            first = own;
        }
    }

    std::vector<std::uint32_t> shell_of_piece(mesh.triangles.size(), UINT32_MAX);
    std::vector<Shell> shells;
    const auto shell_of = [&](std::uint32_t triangle) -> std::uint32_t& {
        return shell_of_piece[sets.find(piece[triangle])];
    };
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (shell_of(t) == UINT32_MAX) {
            shell_of(t) = static_cast<std::uint32_t>(shells.size());
            shells.emplace_back();
        }
        shells[shell_of(t)].triangles.push_back(t);
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto sides = edges.sides(e);
        for (const HalfEdge h : sides) {
            const std::uint32_t own = shell_of(h / 3);
            if (imbalance(mesh, sides, [&](HalfEdge g) { return shell_of(g / 3) == own; }) != 0)
                shells[own].closed = false;
        }
    }
    return shells;
}

/// The volume about the centre of the boxes, which also makes sense of an open surface.
double volume_about_center(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles, const Vec3& center) {
    double six_times = 0;
    for (const std::uint32_t t : triangles) {
        const auto& [a, b, c] = mesh.triangles[t];
        six_times += dot(mesh.vertices[a] - center, cross(mesh.vertices[b] - center, mesh.vertices[c] - center));
    }
    return six_times / 6;
}

/// Whether `inner` lies inside `outer`, which is closed, whatever the sense of either.
bool contains(const TriangleMesh& mesh, const Shell& outer, const Shell& inner) {
    for (std::size_t a = 0; a < 3; ++a)
        if (inner.box.lower[a] < outer.box.lower[a] || inner.box.upper[a] > outer.box.upper[a]) return false;
    if (std::abs(inner.volume) >= std::abs(outer.volume)) return false;
    TriangleMesh surface;
    surface.vertices = mesh.vertices;
    for (const std::uint32_t t : outer.triangles) surface.triangles.push_back(mesh.triangles[t]);
    return std::abs(exact_winding_number(surface, mesh.vertices[mesh.triangles[inner.triangles[0]][0]])) > 0.5;
}

}  // namespace

void orient_triangles(TriangleMesh& mesh, MeshReport& report) {
    const EdgeTable edges(mesh);
    const std::vector<std::uint32_t> piece = orient_pieces(mesh, edges, report);
    std::vector<Shell> shells = find_shells(mesh, edges, piece);

    // Volumes: closed shells each by itself, open ones together
    std::vector<std::uint32_t> open_triangles;
    Bounds open_box;
    for (Shell& shell : shells) {
        for (const std::uint32_t t : shell.triangles) shell.box.add(triangle_box(mesh, t));
        shell.volume = volume_about_center(mesh, shell.triangles, shell.box.center());
        if (shell.closed) continue;
        open_triangles.insert(open_triangles.end(), shell.triangles.begin(), shell.triangles.end());
        open_box.add(shell.box);
    }
    const bool open_inside_out =
        !open_triangles.empty() && volume_about_center(mesh, open_triangles, open_box.center()) < 0;

    // Outermost shells that are inside out, and all that they hold
    for (Shell& shell : shells) {
        if (!shell.closed) {
            shell.inside_out = open_inside_out;
            continue;
        }
        if (shell.volume >= 0) continue;
        const bool outermost = std::none_of(shells.begin(), shells.end(), [&](const Shell& other) {
            return other.closed && contains(mesh, other, shell);
        });
        if (!outermost) continue;
        shell.inside_out = true;
        for (Shell& inner : shells)
            if (inner.closed && contains(mesh, shell, inner)) inner.inside_out = true;
    }
    for (const Shell& shell : shells) {
        if (!shell.inside_out) continue;
        report.inside_out = true;
        for (const std::uint32_t t : shell.triangles) turn(mesh.triangles[t]);
    }
}

}  // namespace phyxel
