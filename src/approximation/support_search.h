#pragma once

#include <vector>

#include "sampling/sampling.h"

namespace phyxel {

/// Finds the nodes in the support of a point by walking over touching cells, breadth first, within 1.25 support radii:
/// what lies across a gap is never reached. One object a thread.
class SupportSearch {
public:
    explicit SupportSearch(const Sampling& sampling);

    /// Nodes closer than `radius` to `position` (lattice frame), reachable from `cell`; ascending.
    const std::vector<std::uint32_t>& find(const Vec3& position, std::uint32_t cell, double radius);

private:
    const Sampling& sampling_;
    std::vector<std::uint32_t> seen_cell_, seen_node_;  ///< [cells], [nodes] number of the last search that met it
    std::uint32_t search_ = 0;
    std::vector<std::uint32_t> queue_, nodes_;
};

/// The nodes around one point, with the support radius that a sound fit needs.
struct Support {
    std::vector<std::uint32_t> nodes;  ///< ascending
    std::vector<Vec3> offsets;         ///< [nodes] node minus point [m]
    double radius = 0;                 ///< [m]
    bool widened = false;
};

/// Collects the support of a point: at least eight nodes whose smallest weighted variance exceeds 1e-2 a^2, else the
/// radius is widened by 1.12, at most twelve times; after that what is there must do. A point that reaches no node at
/// all (a speck of its own) gets the nearest one.
void find_support(SupportSearch& search, const Sampling& sampling, KernelShape kernel, double radius,
                  const Vec3& position, std::uint32_t cell, Support& out);

}  // namespace phyxel
