#pragma once

#include <cstdint>
#include <vector>

#include "base/threads.h"
#include "material/law.h"
#include "phyxel/body.h"
#include "sampling/sampling.h"

namespace phyxel {

/// What each quadrature point of a body of several materials is made of.
struct Mixture {
    std::vector<Material> materials;      ///< [1 + regions] the body's own, then the regions'
    std::vector<std::uint32_t> offset;    ///< [points + 1] into the two below
    std::vector<std::uint16_t> material;  ///< index into `materials`
    std::vector<double> share;            ///< > 0; those of a point add up to 1

    bool empty() const { return materials.empty(); }
    bool holds(std::size_t material_index) const;  ///< whether any point has a share of it
    std::uint16_t main_material(std::size_t q) const;
    MaterialPoint point(std::size_t q) const;  ///< moduli and k_v: means by share; the law: of the largest share

    /// Mean of a number of the materials at point q, by share.
    double mean(std::size_t q, double Material::*number) const;
};

/// Decides what each point is made of; empty without regions. A point stands for its octant (for its box of a
/// body-centred lattice, or for the cell of its node), and has the share of each material that fills it: exactly for a
/// box along the lattice, by the signed distance d of the octant's centre, 1/2 - d/w within 0 and 1, for spheres and
/// meshes, w the octant's width. A wider `transition` takes the place of w. Where laws differ the largest share has the
/// point for itself. Throws `Error` when a transition joins two laws, or a mesh has no inside.
Mixture mix(const Sampling& sampling, const BodySettings& settings, const Threads& threads);

}  // namespace phyxel
