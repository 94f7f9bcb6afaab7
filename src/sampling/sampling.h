#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cell_components.h"
#include "geometry/clipping.h"
#include "geometry/mesh_check.h"
#include "sampling/lattice_frame.h"

namespace phyxel {

inline constexpr std::uint32_t no_index = 0xffffffffu;

/// Nodes, quadrature points and cells of a body, in the lattice frame. A *cell* is one connected part of the solid
/// inside one box of the lattice; cells form a graph (who touches whom), and whatever looks for neighbours walks it, so
/// that parts on the two sides of a gap never see each other.
///   cubic: the boxes are the cubes of edge `spacing` around the nodes; a cell carries one node, or none when it is
///   filled
///          by less than 0.1 %.
///   bcc:   the boxes are the eighths of the conventional cells; each has a corner node and a centre node at the two
///   ends of
///          one of its diagonals. Nodes lie at odd multiples of half the pitch.
struct Sampling {
    LatticeFrame frame;
    Lattice lattice = Lattice::cubic;
    Quadrature quadrature = Quadrature::grid;
    double spacing = 0;  ///< [m]
    double pitch = 0;    ///< [m] edge of a box: `spacing`, or half of it (bcc)

    std::vector<Vec3> nodes;               ///< [nodes] positions [m]
    std::vector<std::uint32_t> node_cell;  ///< [nodes] a cell that holds the node

    std::vector<Vec3> cell_centers;                        ///< [cells] centre of the cell's box [m]
    std::vector<std::array<std::uint32_t, 2>> cell_nodes;  ///< [cells] nodes of the cell, `no_index` for none
    std::vector<std::uint32_t> neighbor_offset;            ///< [cells + 1]
    std::vector<std::uint32_t> neighbors;                  ///< cells that touch

    std::vector<Vec3> points;               ///< [points] quadrature points [m]
    std::vector<double> volumes;            ///< [points] V_q [m^3]; they add up to the clipped volume
    std::vector<std::uint32_t> point_cell;  ///< [points]
    std::vector<std::uint32_t> point_node;  ///< [points] the node a point sits on, or `no_index`
    std::vector<std::uint8_t> point_kind;  ///< [points] place in the unit cell of a whole octant, `irregular` otherwise
    static constexpr std::uint8_t irregular = 255;

    std::vector<double> node_volumes;  ///< [nodes] of whole cells; empty: lumped from the points

    std::vector<SurfacePoint> boundary;        ///< closed boundary of the clipped region
    std::vector<std::uint32_t> boundary_cell;  ///< [boundary]
    double clipped_volume = 0;                 ///< [m^3] sum of `volumes`
    double volume_scale = 1;         ///< what clipped volumes were multiplied with, to be those of the checked mesh
    std::size_t split_boxes = 0;     ///< boxes that hold more than one cell
    std::size_t merged_octants = 0;  ///< slivers that went to a neighbour

    /// The cell at a point of the surface, looked for a little inside of it.
    std::uint32_t locate(const Vec3& position, const Vec3& outward) const;

    std::vector<std::array<std::int32_t, 3>>
        cell_box;  ///< [cells] lattice index of the cell's box, which is centred on `pitch` times it; sorted
    std::vector<Vec3> cell_centroids;  ///< [cells] of the solid in the cell [m]
};

/// Samples a mesh that `check_and_repair` passed; `settings` give the lattice. Throws `Error` when the body gets fewer
/// than four nodes or all of them in a plane.
Sampling sample(const CheckedMesh& mesh, const BodySettings& settings, double spacing, const Threads& threads);

/// Node spacing that gives about `settings.count` nodes: within 2 % where the lattice allows it, else the nearest
/// found. (The nodes of a cube on its lattice are (n + 1)^3 and nothing between.)
double spacing_for_count(const CheckedMesh& mesh, const BodySettings& settings, const Threads& threads);

/// `counts` whole cubic cells with one node and one point each, the thesis' bodies: nothing is clipped.
Sampling whole_cells(const std::array<int, 3>& counts, double spacing);

}  // namespace phyxel
