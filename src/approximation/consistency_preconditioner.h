#pragma once

#include <memory>
#include <span>

#include "approximation/consistency_matrix.h"

namespace phyxel {

/// Two-level overlapping Schwarz preconditioner of the consistency matrix: the inverse of each extended block's part of
/// the matrix, plus the inverse on a coarse space. S nearly annihilates functions that are smooth, as a
/// fourth-order operator does, so that the coarse space must hold the linear ones: {1, x, y, z} of each block, faded
/// out over its overlap. Symmetric and positive definite. Source: Toselli & Widlund, Domain Decomposition Methods,
/// 2005, chapter 3.
class ConsistencyPreconditioner {
public:
    ConsistencyPreconditioner(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, double overlap,
                              const Threads& threads);
    ~ConsistencyPreconditioner();

    /// z = M^-1 r, three columns at once.
    void apply(std::span<const Vec3> r, std::span<Vec3> z, const Threads& threads);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace phyxel
