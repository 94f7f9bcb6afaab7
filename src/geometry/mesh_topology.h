#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "phyxel/mesh.h"

namespace phyxel {

/// A half-edge is side `k` of triangle `t`, from its corner k to the next one, and is called 3 t + k.
using HalfEdge = std::uint32_t;

inline std::uint32_t origin_of(const TriangleMesh& mesh, HalfEdge h) { return mesh.triangles[h / 3][h % 3]; }
inline std::uint32_t target_of(const TriangleMesh& mesh, HalfEdge h) { return mesh.triangles[h / 3][(h % 3 + 1) % 3]; }

/// Which triangles meet at which edge.
class EdgeTable {
public:
    explicit EdgeTable(const TriangleMesh& mesh);

    std::size_t size() const { return begins_.size() - 1; }
    /// The half-edges that make up edge `e`, by triangle.
    std::span<const HalfEdge> sides(std::size_t e) const {
        return std::span(half_edges_).subspan(begins_[e], begins_[e + 1] - begins_[e]);
    }

private:
    std::vector<HalfEdge> half_edges_;  ///< [3 triangles] edge by edge
    std::vector<std::size_t> begins_;   ///< [edges + 1] into `half_edges_`
};

/// Disjoint sets of the numbers below n; a set is called by its smallest member.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t n);
    std::uint32_t find(std::uint32_t i);
    void unite(std::uint32_t i, std::uint32_t j);

private:
    std::vector<std::uint32_t> parent_;
};

/// A loop of edges that have one triangle only.
struct Hole {
    Vec3 center;        ///< mean along the loop
    double length = 0;  ///< of the loop
};
std::vector<Hole> find_holes(const TriangleMesh& mesh, const EdgeTable& edges);  ///< longest first

/// Parts of the surface that share no vertex.
std::size_t count_components(const TriangleMesh& mesh);

/// The connected parts of a surface, each a mesh of its own, in the order of their first triangles.
std::vector<TriangleMesh> split_components(const TriangleMesh& mesh);

/// Vertices whose triangles do not form one fan around edges of two triangles.
std::size_t count_nonmanifold_vertices(const TriangleMesh& mesh, const EdgeTable& edges);

}  // namespace phyxel
