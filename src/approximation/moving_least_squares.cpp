#include "approximation/moving_least_squares.h"

#include <algorithm>

#include "approximation/kernel.h"
#include "base/eigen3.h"

namespace phyxel {
namespace {

/// Share of the trace below which a direction counts as not spanned.
constexpr double spanned = 1e-3;

/// Share of the squared support below which a variance of positions is rounding: nodes at one place span nothing.
constexpr double rounding = 1e-20;

/// Inverse of a symmetric matrix on the directions that carry at least `spanned` of its trace, and more than `least`.
Mat3 inverse_on_span(const Mat3& C, double least, int& rank) {
    const double t = trace(C);
    rank = 3;
    // The smallest eigenvalue is the determinant over the product of the others, which is at most (trace/2)^2.
    if (t > 3 * least / spanned && 4 * determinant(C) > 1.01 * spanned * t * t * t) return inverse(C);
    const SymmetricEigen3 eigen = symmetric_eigen(C);
    rank = 0;
    Mat3 inverse_;
    for (int k = 0; k < 3; ++k) {
        if (!(eigen.values[k] >= spanned * t) || eigen.values[k] <= least) continue;
        ++rank;
        const Vec3 e = eigen.vectors.column(k);
        inverse_ += outer(e, e) * (1 / eigen.values[k]);
    }
    return rank == 3 ? inverse(C) : inverse_;
}

}  // namespace

MovingLeastSquares::Fit MovingLeastSquares::fit(std::span<const Vec3> offsets, ShapeFunctions& out) {
    Fit f{};
    w_.resize(offsets.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        w_[i] = weight(kernel_, norm(offsets[i]) / support_);
        f.total += w_[i];
        f.mean += w_[i] * offsets[i];
    }
    f.mean /= f.total;
    Mat3 C;
    for (std::size_t i = 0; i < offsets.size(); ++i) C += outer(w_[i] * (offsets[i] - f.mean), offsets[i] - f.mean);
    f.inverse = inverse_on_span(C, rounding * f.total * support_ * support_, out.rank);
    return f;
}

void MovingLeastSquares::values(std::span<const Vec3> offsets, ShapeFunctions& out) {
    const Fit f = fit(offsets, out);
    const Vec3 slope = f.inverse * f.mean;
    out.phi.resize(offsets.size());
    for (std::size_t i = 0; i < offsets.size(); ++i)
        out.phi[i] = w_[i] * (1 / f.total - dot(slope, offsets[i] - f.mean));
}

void MovingLeastSquares::values_and_gradients(std::span<const Vec3> offsets, ShapeFunctions& out) {
    const Fit f = fit(offsets, out);
    const std::size_t n = offsets.size();
    const Vec3 slope = f.inverse * f.mean;
    out.phi.resize(n);
    out.gradient.resize(n);

    if (out.rank < 3) {
        // Not a volume: the linear fit on the spanned directions, whose gradient is constant (diffuse).
        for (std::size_t i = 0; i < n; ++i) {
            out.phi[i] = w_[i] * (1 / f.total - dot(slope, offsets[i] - f.mean));
            out.gradient[i] = w_[i] * (f.inverse * (offsets[i] - f.mean));
        }
        return;
    }

    // y = A^-1 [1 0 0 0]: y(r) = 1/W + m.C^-1 m - (C^-1 m).r, and B = sum_i p_i y(r_i) grad w_i^T, its first row and
    // the rest.
    const double y0 = 1 / f.total + dot(slope, f.mean);
    Vec3 b0{};
    Mat3 b1{};
    for (std::size_t i = 0; i < n; ++i) {
        const double distance = norm(offsets[i]), y = y0 - dot(slope, offsets[i]);
        out.phi[i] = w_[i] * y;
        // grad w with respect to the point: it grows towards the node.
        const Vec3 dw = distance > 0
                            ? offsets[i] * (-weight_derivative(kernel_, distance / support_) / (support_ * distance))
                            : Vec3{};
        out.gradient[i] = y * dw;
        b0 += out.gradient[i];
        b1 += outer(offsets[i], out.gradient[i]);
    }
    // Z = A^-1 ([0; I] - B), A^-1 = [1/W + m.C^-1 m, -(C^-1 m)^T; -C^-1 m, C^-1].
    const Mat3 rest = Mat3::identity() - b1;
    const Mat3 z1 = f.inverse * rest + outer(slope, b0);
    const Vec3 z0 = -y0 * b0 - transpose(rest) * slope;
    for (std::size_t i = 0; i < n; ++i) out.gradient[i] += w_[i] * (z0 + transpose(z1) * offsets[i]);
}

void MovingLeastSquares::nodal_gradients(std::span<const Vec3> offsets, std::size_t self, ShapeFunctions& out) {
    const std::size_t n = offsets.size();
    out.phi.assign(n, 0);
    out.gradient.resize(n);
    Mat3 A;
    w_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        w_[i] = i == self ? 0 : weight(kernel_, norm(offsets[i]) / support_);
        A += outer(w_[i] * offsets[i], offsets[i]);
    }
    const Mat3 A_inverse = inverse_on_span(A, 0, out.rank);
    Vec3 sum{};
    for (std::size_t i = 0; i < n; ++i) {
        out.gradient[i] = A_inverse * (w_[i] * offsets[i]);
        sum += out.gradient[i];
    }
    out.gradient[self] = -sum;
    out.phi[self] = 1;
}

}  // namespace phyxel
