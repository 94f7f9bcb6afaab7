#pragma once

#include "base/threads.h"
#include "model/model.h"

namespace phyxel {

/// How the nodes of a deformed body are turned: the rotation in the deformation gradient that the nodes nearest to each
/// one tell of, by least squares. Nearest nodes are enough for frames that a preconditioner works in, and ten times
/// fewer than the stencils hold.
class NodalRotations {
public:
    NodalRotations(const Model& model, const Threads& threads);

    /// Writes the rotations at positions x for the nodes that `turns` says may. Where the neighbourhood is nearly flat
    /// or inverted, a node turns as its neighbours do on average, those that may not turn among them.
    template <class Turns>
    void find(std::span<const Vec3> x, const Threads& threads, Turns&& turns, std::span<Mat3> rotation) const {
        threads.for_each(rotation.size(), 64,
                         [&](std::size_t i) { rotation[i] = turns(i) ? rotation_of(i, x) : Mat3::identity(); });
        follow_neighbors(rotation);
    }

private:
    /// Zero where there is none.
    Mat3 rotation_of(std::size_t node, std::span<const Vec3> x) const;
    void follow_neighbors(std::span<Mat3> rotation) const;

    std::vector<std::uint32_t> offset_{0}, node_;
    std::vector<Vec3> gradient_;  ///< F = sum (x_j - x_i) (x) g_ij
};

}  // namespace phyxel
