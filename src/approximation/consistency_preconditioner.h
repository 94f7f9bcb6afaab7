#pragma once

#include <memory>
#include <span>

#include "approximation/consistency_matrix.h"

namespace phyxel {

/// Two-level preconditioner of the consistency matrix: the inverse of each block's own part of it, plus the inverse on
/// a coarse space. S annihilates linear functions and nearly annihilates smooth ones, as a fourth-order operator does,
/// so that the coarse space must hold the linear functions: {1, x, y, z} of each block, zero outside. Symmetric and
/// positive definite; 60 to 100 iterations for six digits where the diagonal alone needs up to 2,500.
/// Overlapping blocks were tried: a tenth fewer iterations, each more than twice as dear.
class ConsistencyPreconditioner {
public:
    ConsistencyPreconditioner(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, const Threads& threads);
    ~ConsistencyPreconditioner();

    /// z = M^-1 r, three columns at once.
    void apply(std::span<const Vec3> r, std::span<Vec3> z, const Threads& threads);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace phyxel
