#pragma once

#include <cstdint>
#include <vector>

#include "approximation/kernel.h"
#include "sampling/sampling.h"

namespace phyxel {

/// What ties quadrature points to nodes, and all that the forces see: F_q = sum_i x_i (x) g_qi over the nodes i in the
/// support of q, with sum_i g = 0 and sum_i X_i (x) g = I.
///
/// Points come in blocks of neighbouring ones. A block gathers the positions of its nodes once into a small array that
/// stays in the first-level cache, and scatters forces into *slots* of its own, one for each of its nodes; a node's
/// force is the sum of its slots in order, so that the bits do not depend on how blocks are dealt to threads. Points
/// deep inside of a lattice share one template of gradients for each place in the unit cell.
struct Stencils {
    struct Block {
        std::uint32_t point_begin, point_end;
        std::uint32_t slot_begin, slot_end;
    };
    std::vector<Block> blocks;
    std::vector<std::uint32_t> slot_node;         ///< [slots] node of a slot
    std::vector<std::uint32_t> node_slot_offset;  ///< [nodes + 1] into `node_slots`
    std::vector<std::uint32_t> node_slots;        ///< [slots] slots of each node, ascending

    std::vector<std::uint32_t> offset;          ///< [points + 1] into `local`
    std::vector<std::uint16_t> local;           ///< [pairs] slot of the pair's node, counted from the block's first
    std::vector<std::uint32_t> gradient_begin;  ///< [points] into `gradient`
    std::vector<Vec3> gradient;                 ///< g_qi [1/m] in rest space, each point's in the order of its pairs
    std::vector<float> support;  ///< [points] support radius over the body's; above 1 where it was widened

    std::size_t points() const { return gradient_begin.size(); }
    std::size_t pairs() const { return local.size(); }
};

/// How a build of stencils went.
struct StencilReport {
    std::size_t widened = 0;        ///< points whose support had to be widened
    std::size_t deficient = 0;      ///< points whose nodes span no volume even so
    Vec3 deficient_place{};         ///< one of them, rest space
    double consistency_before = 0;  ///< largest violation of the patch condition, before the correction
    double consistency_after = 0;
    bool consistent = true;  ///< the correction converged, or was not asked for
};

/// Settings of the approximation of one body, resolved.
struct ApproximationSettings {
    KernelShape kernel = KernelShape::quartic_spline;
    double support = 0;            ///< radius [m]
    bool nodal_gradients = false;  ///< paper A's gradients at points that sit on nodes
    bool consistency_correction = true;
};

/// The kernel of a body from its settings: the thesis' poly6 for points at nodes, the quartic spline of paper B for a
/// grid, unless another is asked for.
KernelShape kernel_shape(const BodySettings& settings);

/// Support radius [m] of a body from its settings: the kernel's, in spacings, or the mean distance of the `neighbors`
/// nearest nodes of the infinite lattice times `dilation`.
double support_radius(const BodySettings& settings, double spacing);

struct StencilBuild {
    Stencils stencils;
    std::vector<double> node_volumes;  ///< [nodes] V_q shared out by Shepard weights; they add up to the body's volume
    StencilReport report;
};

/// Sorts the points of `sampling` into blocks and builds their stencils.
StencilBuild build_stencils(Sampling& sampling, const ApproximationSettings& settings, const Threads& threads);

}  // namespace phyxel
