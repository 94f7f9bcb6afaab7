#pragma once

#include "phyxel/mesh.h"

namespace phyxel {

/// Repairs of a mesh, each counted in the report. They move no vertex further than the welding tolerance.

/// Positions closer than this times the longest side of the bounding box are one vertex.
constexpr double weld_tolerance = 1e-9;

/// Gives vertices at the same place one number, and drops those that no triangle uses. Numbers keep the order of first
/// appearance. Returns the new number of every old vertex, UINT32_MAX where it was dropped.
std::vector<std::uint32_t> weld_vertices(TriangleMesh& mesh, MeshReport& report);

/// Drops triangles with a vertex twice, and all but one of those with the same vertices in the same sense. Triangles
/// whose corners lie on one line stay: without them, the surface would come apart along that line.
void drop_useless_triangles(TriangleMesh& mesh, MeshReport& report);

/// Drops the vertices that no triangle uses any more, and counts them; `vertex_of` [vertices as read] follows.
void drop_unused_vertices(TriangleMesh& mesh, std::vector<std::uint32_t>& vertex_of, MeshReport& report);

/// Turns triangles so that neighbours agree about outside (the smaller part of each connected piece is turned), then
/// turns closed shells, with all that lies inside them, that are inside out and not inside another shell (these are
/// cavities and stay). Open pieces are turned together when their volume about their centre is negative.
void orient_triangles(TriangleMesh& mesh, MeshReport& report);

}  // namespace phyxel
