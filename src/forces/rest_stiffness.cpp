#include "forces/rest_stiffness.h"

namespace phyxel {
namespace {

constexpr double shared_gradients = 1e-2;  ///< times the spacing

// Made up for what one point and close gradients leave out, so that a preconditioner does not overshoot: an eigenvalue
// of V A above 4/3 would let a body at rest, whose steps are one correction each, swing within their tolerance.
constexpr float elastic_share = 1.15f, filter_share = 3;

/// Only grid points of a cubic lattice come in eights around one centre.
CellPoints points_for(const Model& m) {
    const bool eights = m.sampling.quadrature == Quadrature::grid && m.sampling.lattice == Lattice::cubic;
    return eights ? CellPoints::mean : CellPoints::all;
}

}  // namespace

RestStiffness::RestStiffness(const Model& m, const Threads& threads)
    : cells_(m, threads, {.tolerance = shared_gradients, .points = points_for(m)}), filter_(m) {}

void RestStiffness::apply(const Model& m, std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out) {
    cells_.rest_action(m, d, threads, out);
    threads.for_each(out.size(), 1024, [&](std::size_t i) { out[i] *= elastic_share; });
    filter_.add_once_filtered(d, filter_share, threads, out);
}

}  // namespace phyxel
