#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/threads.h"
#include "phyxel/body.h"
#include "phyxel/vector.h"

namespace phyxel {

/// What the consistency correction reads: views into the caller's arrays. The points are those that may be corrected
/// (the "zone", within about one support of the surface); all others stay as they are.
struct ConsistencyInput {
    std::span<const Vec3> nodes;            // [nodes] X_i [m], all nodes of the body
    std::span<const Vec3> points;           // [points] X_q [m]
    std::span<const double> volumes;        // [points] V_q [m^3]
    std::span<const double> support;        // [points] h_q [m]
    std::span<const std::uint32_t> offset;  // [points + 1] first pair of a point
    std::span<const std::uint32_t> node;    // [pairs] i
    std::span<const Vec3> residual;         // [nodes] r_i = b_i - sum of V_q g_qi over all points of the body [m^2]
    KernelShape kernel = KernelShape::quartic_spline;
};

/// What the correction did. Residuals are the largest |r_i| over the largest sum_q V_q |g_qi| of a node (or over the
/// largest |r_i| at the start, where that is greater): about half the error of the force patch test, which is relative
/// to |b_i|.
struct ConsistencyReport {
    double residual_before = 0;
    double residual_after = 0;
    int iterations = 0;
    bool converged = true;       // false: residual_after is as far as it went
    std::size_t zone_nodes = 0;  // nodes seen by at least one of the points
};

/// Makes the quadrature pass the patch test: a constant stress gives no force on an inner node only if, for every node,
///     sum_q V_q g_qi = b_i,   the integral of phi_i n over the closed surface,
/// which points in cells that are cut by the surface miss by some per cent. Of all changes d_qi of the gradients that
/// mend it and keep each stencil exact for linear fields, the smallest is added to `gradient` ([pairs], [1/m]):
///     minimize sum_q V_q sum_i |d_qi|^2 / w_qi   subject to   sum_i p_qi d_qi = 0,   sum_q V_q d_qi = r_i,
/// w_qi the weight of node i at point q, p_qi = [1, (X_i - X_q)/h_q]. Its solution is d_q = S_q lambda, where
///     S_q = W - W P (P^T W P)^+ P^T W   and   (sum_q V_q S_q) lambda = r,
/// one sparse positive semidefinite system with three right-hand sides. It cannot repair a residual outside the range
/// of the matrix (sum_i r_i = 0 and sum_i X_i (x) r_i = 0 are needed in each connected part, among others); that part
/// of it is left and reported. The same bits for any number of threads.
ConsistencyReport make_consistent(const ConsistencyInput& input, std::span<Vec3> gradient, const Threads& threads);

}  // namespace phyxel
