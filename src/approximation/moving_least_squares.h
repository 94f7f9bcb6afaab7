#pragma once

#include <span>
#include <vector>

#include "phyxel/body.h"

namespace phyxel {

/// Shape functions of the nodes around one point.
struct ShapeFunctions {
    std::vector<double> phi;     ///< [nodes] sum phi = 1, sum phi X = point
    std::vector<Vec3> gradient;  ///< [nodes] [1/m] sum g = 0, sum X (x) g = I
    int rank = 0;                ///< dimensions that the nodes span: 3, or less for a plate, a strand, a lump
};

/// Moving least squares with a linear basis at the origin; `offsets` are node positions relative to the point.
///
///   A = sum_i w_i p_i p_i^T,  p = [1, X_i - X],   phi_i = [1 0 0 0] A^-1 p_i w_i          (Brunet et al. 2019, eq. 7)
///   d_k phi_i = e_k A^-1 p_i w_i - [1 0 0 0] A^-1 (d_k A) A^-1 p_i w_i + [1 0 0 0] A^-1 p_i d_k w_i
///
/// The paper prints the middle term without A^-1 on both sides. The basis is centred on the point and A is inverted
/// through the covariance C of the positions about their weighted mean m, which is where planar neighbourhoods show:
/// directions whose eigenvalue is below 1e-3 of the trace are left out, and sum X (x) g is then the projector onto the
/// rest. Any regularization instead would break exactness for linear fields.
class MovingLeastSquares {
public:
    MovingLeastSquares(KernelShape kernel, double support) : kernel_(kernel), support_(support) {}

    /// Shape values only.
    void values(std::span<const Vec3> offsets, ShapeFunctions& out);
    /// Shape values and full gradients (paper B).
    void values_and_gradients(std::span<const Vec3> offsets, ShapeFunctions& out);
    /// Gradients at a node, `offsets[self] = 0` (paper A, 3.32): g_j = A^-1 X_j w_j for the others, g_self = -sum, with
    /// A = sum w X_j X_j^T; phi is 1 at the node itself, since the thesis takes coefficients for positions.
    void nodal_gradients(std::span<const Vec3> offsets, std::size_t self, ShapeFunctions& out);

private:
    struct Fit {
        double total;  // W = sum w
        Vec3 mean;     // m
        Mat3 inverse;  // C^+ on the spanned subspace
    };
    Fit fit(std::span<const Vec3> offsets, ShapeFunctions& out);

    KernelShape kernel_;
    double support_;
    std::vector<double> w_;
};

}  // namespace phyxel
