#pragma once

#include <cmath>

#include "phyxel/vector.h"

/// The rotation of a deformation gradient: F = R S with det R = +1 and S symmetric, R the rotation nearest to F.
///
/// The unit quaternion of R is the eigenvector of the largest eigenvalue l of the symmetric 4x4 matrix
///     K = [[tr F, z^T], [z, F + F^T - tr F I]],  z = (F32 - F23, F13 - F31, F21 - F12)
/// (Davenport's q-method; Horn, J. Opt. Soc. Am. A 4, 1987, 629), whose characteristic polynomial is
///     p(l) = l^4 - 2 |F|^2 l^2 - 8 det F l + |F|^4 - 4 |cof F|^2,
/// with l = tr S. Every column of adj(K - l I) = -p'(l) q q^T is the eigenvector. p'(l) is the product of the gaps
/// 2 (s_i + s_j) between the eigenvalues, so the formula is as accurate as R is well defined; where a gap is small
/// (strong inversion, rank one) the singular value decomposition takes over.

namespace phyxel {

namespace polar_detail {

/// R = U V^T of the rotation-variant decomposition: some nearest rotation, also where there are several.
Mat3 rotation_by_svd(const Mat3& F);

/// Largest root of p by Newton's method from the upper bound sqrt(3) |F|; p is convex and rising above that root.
inline double largest_root(double norm_squared, double det, double constant) {
    double l = std::sqrt(3 * norm_squared);
    for (int iteration = 0; iteration < 40; ++iteration) {
        const double value = ((l * l - 2 * norm_squared) * l - 8 * det) * l + constant;
        const double slope = 4 * (l * l - norm_squared) * l - 8 * det;
        if (!(slope > 0)) break;
        const double next = l - value / slope;
        if (!(next < l)) break;
        const bool converged = l - next < 1e-9 * l;  // quadratic: what is left is below rounding
        l = next;
        if (converged) break;
    }
    return l;
}

/// Rotation matrix of the quaternion (w, v) of any length but zero.
inline Mat3 rotation_of_quaternion(double w, const Vec3& v) {
    const double k = 2 / (w * w + norm_squared(v));
    const Vec3 a = k * v, wa = w * a;
    return {{{1 - a.y * v.y - a.z * v.z, a.x * v.y - wa.z, a.x * v.z + wa.y},
             {a.x * v.y + wa.z, 1 - a.x * v.x - a.z * v.z, a.y * v.z - wa.x},
             {a.x * v.z - wa.y, a.y * v.z + wa.x, 1 - a.x * v.x - a.y * v.y}}};
}

}  // namespace polar_detail

/// Rotation R of the polar decomposition F = R S, det R = +1, for any finite F: inverted, singular and zero ones too.
inline Mat3 polar_rotation(const Mat3& F) {
    // The quartic.
    const double squared = contract(F, F), det = determinant(F);
    const Mat3 cof = cofactor(F);
    const double l = polar_detail::largest_root(squared, det, squared * squared - 4 * contract(cof, cof));

    // Ill-conditioned, empty or beyond the range of squares: the slow way. The bound, relative to |F|^3 (where the
    // identity has 12.3), keeps the closed form within rounding of the singular value decomposition.
    const double gaps = 4 * (l * l - squared) * l - 8 * det;
    const double size_cubed = squared * std::sqrt(squared);
    if (!(gaps > 0.1 * size_cubed) || !(size_cubed > 1e-140) || !(size_cubed < 1e140))
        return polar_detail::rotation_by_svd(F);

    // First column of the adjugate of [[a, z^T], [z, B]]; good unless the rotation is beyond 120 degrees.
    const double a = trace(F) - l;
    const Vec3 z = {F(2, 1) - F(1, 2), F(0, 2) - F(2, 0), F(1, 0) - F(0, 1)};
    const Mat3 B = F + transpose(F) - (trace(F) + l) * Mat3::identity();
    const Mat3 cof_B = cofactor(B);
    const double first = determinant(B);
    const Vec3 below = -(cof_B * z);
    if (std::abs(first) >= 0.25 * gaps) return polar_detail::rotation_of_quaternion(first, below);

    // Otherwise the column with the largest diagonal entry; the lower block is a adj(B) + [z]x B [z]x.
    const Mat3 zx = {{{0, -z.z, z.y}, {z.z, 0, -z.x}, {-z.y, z.x, 0}}};
    const Mat3 block = a * cof_B + zx * B * zx;
    std::size_t k = 0;
    for (std::size_t c = 1; c < 3; ++c)
        if (std::abs(block(c, c)) > std::abs(block(k, k))) k = c;
    return polar_detail::rotation_of_quaternion(below[k], block.column(k));
}

}  // namespace phyxel
