#include "base/svd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/largest_entry.h"

namespace phyxel {
namespace {

void turn(Vec3& a, Vec3& b, double c, double s) {
    const Vec3 old = a;
    a = c * old - s * b;
    b = s * old + c * b;
}

/// Turns the columns `p` and `q` of B and V in their plane until those of B are orthogonal; false if they were.
bool orthogonalize(Vec3 (&B)[3], Vec3 (&V)[3], std::size_t p, std::size_t q) {
    const double pp = norm_squared(B[p]), qq = norm_squared(B[q]), pq = dot(B[p], B[q]);
    if (std::abs(pq) <= std::numeric_limits<double>::epsilon() * std::sqrt(pp * qq)) return false;
    const double zeta = (qq - pp) / (2 * pq);
    const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(zeta, 1.0));
    const double c = 1 / std::sqrt(t * t + 1);
    turn(B[p], B[q], c, t * c);
    turn(V[p], V[q], c, t * c);
    return true;
}

Vec3 any_perpendicular(const Vec3& a) {
    const double x = std::abs(a.x), y = std::abs(a.y), z = std::abs(a.z);
    const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    return normalized(cross(a, axis));
}

}  // namespace

Svd3 rotation_variant_svd(const Mat3& A) {
    // Scaled to entries near one, so that no square over- or underflows.
    const double scale = largest_entry(A);
    if (scale == 0) return {Mat3::identity(), {}, Mat3::identity()};
    Mat3 scaled;
    for (std::size_t r = 0; r < 3; ++r) scaled.rows[r] = A.rows[r] / scale;

    // Orthogonal columns B = A V; four or five sweeps, the limit is never reached.
    Vec3 B[3] = {scaled.column(0), scaled.column(1), scaled.column(2)};
    Vec3 V[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 30; ++sweep) {
        const bool turned_xy = orthogonalize(B, V, 0, 1);
        const bool turned_xz = orthogonalize(B, V, 0, 2);
        const bool turned_yz = orthogonalize(B, V, 1, 2);
        if (!turned_xy && !turned_xz && !turned_yz) break;
    }

    // Longest first; V stays a rotation.
    std::size_t order[3] = {0, 1, 2};
    std::stable_sort(order, order + 3,
                     [&](std::size_t a, std::size_t b) { return norm_squared(B[a]) > norm_squared(B[b]); });
    const Vec3 v0 = V[order[0]], v1 = V[order[1]], v2 = cross(v0, v1);

    // U column by column, each orthogonal to those before it; the last value carries the sign of det A.
    const Vec3 b0 = B[order[0]], b1 = B[order[1]];
    const Vec3 u0 = normalized(b0);
    const Vec3 rest = b1 - dot(b1, u0) * u0;
    const bool rank_one = norm(rest) <= std::numeric_limits<double>::min() * 1e20;
    const Vec3 u1 = rank_one ? any_perpendicular(u0) : normalized(rest);
    const Vec3 u2 = normalized(cross(u0, u1));
    const Vec3 values = {norm(b0), dot(b1, u1), dot(u2, scaled * v2)};
    return {Mat3::from_columns(u0, u1, u2), scale * values, Mat3::from_columns(v0, v1, v2)};
}

}  // namespace phyxel
