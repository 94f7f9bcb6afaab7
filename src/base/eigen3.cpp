#include "base/eigen3.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/largest_entry.h"

namespace phyxel {
namespace {

/// Turns the plane (p, q) so that A(p, q) becomes zero; `V` gathers the turns.
void rotate_plane(Mat3& A, Mat3& V, std::size_t p, std::size_t q) {
    if (A(p, q) == 0) return;

    // The smaller of the two angles, from t^2 + 2 theta t - 1 = 0.
    const double theta = (A(q, q) - A(p, p)) / (2 * A(p, q));
    const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;

    const std::size_t r = 3 - p - q;
    const double shift = t * A(p, q), rp = A(r, p), rq = A(r, q);
    A(p, p) -= shift;
    A(q, q) += shift;
    A(p, q) = A(q, p) = 0;
    A(r, p) = A(p, r) = c * rp - s * rq;
    A(r, q) = A(q, r) = s * rp + c * rq;
    for (Vec3& row : V.rows) {
        const double vp = row[p], vq = row[q];
        row[p] = c * vp - s * vq;
        row[q] = s * vp + c * vq;
    }
}

double off_diagonal(const Mat3& A) { return std::max({std::abs(A(0, 1)), std::abs(A(0, 2)), std::abs(A(1, 2))}); }

}  // namespace

SymmetricEigen3 symmetric_eigen(const Mat3& matrix) {
    // Scaled to entries near one, so that nothing over- or underflows.
    const double scale = largest_entry(matrix);
    if (scale == 0) return {{}, Mat3::identity()};
    Mat3 A;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) A(r, c) = 0.5 * (matrix(r, c) / scale + matrix(c, r) / scale);

    // Convergence is quadratic: four or five sweeps; the limit is never reached.
    Mat3 V = Mat3::identity();
    for (int sweep = 0; sweep < 30 && off_diagonal(A) > 1e-300; ++sweep) {
        rotate_plane(A, V, 0, 1);
        rotate_plane(A, V, 0, 2);
        rotate_plane(A, V, 1, 2);
    }

    // Ascending, right-handed.
    std::size_t order[3] = {0, 1, 2};
    std::stable_sort(order, order + 3, [&](std::size_t a, std::size_t b) { return A(a, a) < A(b, b); });
    const Vec3 first = V.column(order[0]), second = V.column(order[1]);
    const Vec3 values = {A(order[0], order[0]), A(order[1], order[1]), A(order[2], order[2])};
    return {scale * values, Mat3::from_columns(first, second, cross(first, second))};
}

}  // namespace phyxel
