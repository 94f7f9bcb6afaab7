#pragma once

#include "solver/multigrid.h"
#include "solver/nodal_rotations.h"

namespace phyxel {

/// z = R V R^T r: the multigrid of the body at rest, seen from frames that turn with the nodes. It replaces the tangent
/// of the current state and needs no matrix of it; unturned it would be useless once a body has bent.
class WarpedPreconditioner {
public:
    WarpedPreconditioner(const Model& model, const Constraints& constraints, const Threads& threads);

    void set_weights(double stiffness, double inertia, const Threads& threads);
    /// Adds stiffness of the nodes' own, of contact say, until the next call: `blocks` [nodes], empty for none, in the
    /// frame of the world; after `turn`.
    void set_supports(std::vector<Mat3> blocks, const Threads& threads);
    /// Finds the rotations of the nodes at positions x; none where a component of the node is held.
    void turn(std::span<const Vec3> x, const Threads& threads);
    void apply(const std::vector<Vec3>& r, std::vector<Vec3>& z, const Threads& threads);

private:
    RestMultigrid multigrid_;
    NodalRotations rotations_;
    std::vector<Mat3> rotation_;  ///< [nodes]
};

}  // namespace phyxel
