#pragma once

#include <array>

#include "model/model.h"

namespace phyxel {

/// The quadrature points of a body dealt out to groups of at most eight that see nearly the same nodes: with grid
/// quadrature on a cubic lattice the points of one lattice cell between nodes, which all see the 4x4x4 nodes around it
/// (a clipped centroid may reach a fifth plane). All have one law. The *window* of a group are the nodes that its
/// points see, in the order of their places around the cell, so that groups with equal windows can be put side by side.
struct CellGroups {
    using Index3 = std::array<std::int32_t, 3>;

    /// Place of a node in a window: quarters of a spacing from the cell's corner, and which one it is of several nodes
    /// in one box.
    using Place = std::array<std::int16_t, 4>;

    struct Group {
        Index3 cell{};
        std::array<std::uint32_t, 8> point;  ///< by octant, `no_index` for none
        std::uint32_t window_begin = 0, window_end = 0;
        std::uint32_t shape = 0;   ///< groups of equal shape have equal windows, points and, to rounding, gradients
        std::uint32_t family = 0;  ///< groups of one family have equal windows and points, and similar gradients
        Law law{};
        std::uint32_t dilatation_cell = no_index;  ///< whose points share their dilatation, if they do
        bool joined = false;                       ///< the dilatation cell has points in other groups, too

        /// Groups that can go side by side have the same.
        std::uint32_t kind() const {
            return 3 * static_cast<std::uint32_t>(law) + (dilatation_cell == no_index ? 0 : joined ? 2 : 1);
        }
    };
    std::vector<Group> groups;                 ///< sorted by cell
    std::vector<std::uint32_t> node;           ///< [window entries]
    std::vector<Place> place;                  ///< [window entries] ascending in each window
    std::vector<std::uint32_t> shape_leader;   ///< [shapes] the group whose gradients all others are near to
    std::vector<std::uint32_t> family_leader;  ///< [families]

    std::vector<std::uint32_t> point_slot_begin;  ///< [points] first slot of the stencil block that holds the point

    std::size_t window_size(const Group& group) const { return group.window_end - group.window_begin; }

    /// Writes g a of one point of a group over the group's window, zero where the point does not see the node; a is
    /// the node spacing.
    void spread_gradients(const Model& model, const Group& group, std::size_t octant, std::span<Vec3> gradients) const;
    /// The mean over the group's points, each weighted by its volume.
    void spread_mean_gradients(const Model& model, const Group& group, std::span<Vec3> gradients) const;
};

/// Gradients times the spacing (they go up to 0.6) that differ by less count as equal: forces then err by less than
/// 1e-5. What an end of a prism changes in the gradients fades by a third to a half with every cell, but never ends.
inline constexpr double close_gradients = 3e-6;

/// Gradients that differ by less are similar: their differences fit 16 bits (cell_kernel.h).
inline constexpr double similar_gradients = 2e-3;

/// Groups within `tolerance` of each other, as `close_gradients`, get one shape; families are found only if `families`
/// asks for them, else there are no leaders and all numbers are 0.
CellGroups group_cells(const Model& model, double tolerance, bool families, const Threads& threads);

}  // namespace phyxel
