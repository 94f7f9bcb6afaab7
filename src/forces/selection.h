#pragma once

#include <vector>

#include "approximation/embedded_points.h"
#include "model/model.h"

namespace phyxel {

/// The part of a body's surface inside a box, cut at the planes of the octants: a one-point quadrature of each piece,
/// exact for linear fields.
struct SurfaceSelection {
    std::vector<Vec3> position;       ///< [pieces] lattice frame [m]
    std::vector<Vec3> area;           ///< [pieces] outward normal times area, lattice frame [m^2]
    std::vector<std::uint32_t> cell;  ///< [pieces]
    double total_area = 0;            ///< [m^2]
};

/// Clips the surface `mesh` (rest space) to the closed box. Throws `Error` when nothing lies in it.
SurfaceSelection select_surface(const Model& model, const TriangleMesh& mesh, const BoxSelection& box);

}  // namespace phyxel
