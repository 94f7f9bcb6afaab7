#include "reference/brunet_2019.h"

#include <array>
#include <cassert>
#include <cmath>

namespace phyxel::reference::brunet {
namespace {

/// Strain or stress as in eq. 10: xx, yy, zz, xy, yz, xz; shear strains are engineering strains, twice the tensor's.
using Six = std::array<double, 6>;

/// B_j u, eq. 10.
Six strain(const Vec3& g, const Vec3& u) {
    return {g.x * u.x, g.y * u.y, g.z * u.z, g.y * u.x + g.x * u.y, g.z * u.y + g.y * u.z, g.z * u.x + g.x * u.z};
}

/// B_i^T sigma, eq. 10.
Vec3 pull(const Vec3& g, const Six& sigma) {
    return {g.x * sigma[0] + g.y * sigma[3] + g.z * sigma[5], g.y * sigma[1] + g.x * sigma[3] + g.z * sigma[4],
            g.z * sigma[2] + g.y * sigma[4] + g.x * sigma[5]};
}

/// C eps. The article does not print C; with engineering shear its entries for shear are mu, not 2 mu.
Six stress(const Body& body, const Six& eps) {
    const double pressure = body.lambda * (eps[0] + eps[1] + eps[2]);
    return {pressure + 2 * body.mu * eps[0],
            pressure + 2 * body.mu * eps[1],
            pressure + 2 * body.mu * eps[2],
            body.mu * eps[3],
            body.mu * eps[4],
            body.mu * eps[5]};
}

/// sum_j B_j (R^T x_j - X_j), eq. 12.
Six corotated_strain(const Body& body, const Stencil& point, const std::vector<Vec3>& x, const Mat3& R) {
    Six sum{};
    for (std::size_t a = 0; a < point.nodes.size(); ++a) {
        const Vec3 u = transpose(R) * x[point.nodes[a]] - body.X[point.nodes[a]];
        const Six part = strain(point.g[a], u);
        for (std::size_t k = 0; k < 6; ++k) sum[k] += part[k];
    }
    return sum;
}

using Four = std::array<double, 4>;
using Matrix4 = std::array<Four, 4>;

Four times(const Matrix4& A, const Four& b) {
    Four c{};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t k = 0; k < 4; ++k) c[r] += A[r][k] * b[k];
    return c;
}

double dot(const Four& a, const Four& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

/// Inverse by Gauss and Jordan, without pivoting: moment matrices are positive definite.
Matrix4 inverse(Matrix4 A) {
    Matrix4 B{};
    for (std::size_t k = 0; k < 4; ++k) B[k][k] = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        const double pivot = A[k][k];
        assert(pivot > 0 && "a point needs four nodes that are not in one plane");
        for (std::size_t c = 0; c < 4; ++c) A[k][c] /= pivot, B[k][c] /= pivot;
        for (std::size_t r = 0; r < 4; ++r) {
            const double factor = A[r][k];
            if (r == k) continue;
            for (std::size_t c = 0; c < 4; ++c) A[r][c] -= factor * A[k][c], B[r][c] -= factor * B[k][c];
        }
    }
    return B;
}

/// Derivative of the quartic spline by s.
double quartic_spline_slope(double s) { return s >= 1 ? 0 : -12 * s + 24 * s * s - 12 * s * s * s; }

}  // namespace

double quartic_spline(double s) { return s >= 1 ? 0 : 1 - 6 * s * s + 8 * s * s * s - 3 * s * s * s * s; }

Stencil moving_least_squares(const std::vector<Vec3>& X, const Vec3& point, double h, double volume) {
    Stencil stencil{.nodes = {}, .phi = {}, .g = {}, .volume = volume};
    std::vector<Four> basis;      // p_j
    std::vector<double> weights;  // W_Ij
    std::vector<Vec3> slopes;     // their gradients by the point
    Matrix4 A{}, dA[3] = {};
    for (std::size_t j = 0; j < X.size(); ++j) {
        const Vec3 d = X[j] - point;
        const double distance = norm(d), s = distance / h;
        if (s >= 1) continue;
        stencil.nodes.push_back(j);
        basis.push_back({1, d.x / h, d.y / h, d.z / h});
        weights.push_back(quartic_spline(s));
        slopes.push_back(distance > 0 ? -quartic_spline_slope(s) / (h * distance) * d : Vec3{});
        for (std::size_t r = 0; r < 4; ++r)
            for (std::size_t c = 0; c < 4; ++c) {
                const double pp = basis.back()[r] * basis.back()[c];
                A[r][c] += weights.back() * pp;
                for (std::size_t axis = 0; axis < 3; ++axis) dA[axis][r][c] += slopes.back()[axis] * pp;
            }
    }

    // phi_j = p(x)^T A^-1 W_j p_j; at the point itself p = (1, 0, 0, 0), and its slope along an axis is 1/h there. The
    // basis of the nodes is held where the point is while the point moves: shifted along, it would span the same fits.
    const Matrix4 B = inverse(A);
    const Four at_point = times(B, {1, 0, 0, 0});
    Four change[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Four p_slope{};
        p_slope[axis + 1] = 1 / h;
        const Four first = times(B, p_slope), second = times(B, times(dA[axis], at_point));
        for (std::size_t k = 0; k < 4; ++k) change[axis][k] = first[k] - second[k];
    }
    for (std::size_t j = 0; j < basis.size(); ++j) {
        const double value = dot(at_point, basis[j]);
        stencil.phi.push_back(weights[j] * value);
        stencil.g.push_back(weights[j] *
                                Vec3{dot(change[0], basis[j]), dot(change[1], basis[j]), dot(change[2], basis[j])} +
                            value * slopes[j]);
    }
    return stencil;
}

std::vector<double> node_volumes(const Body& body) {
    std::vector<double> v(body.X.size());
    for (const Stencil& point : body.points)
        for (const std::size_t j : point.nodes) v[j] += point.volume / double(point.nodes.size());
    return v;
}

Mat3 deformation_gradient(const Stencil& point, const std::vector<Vec3>& x) {
    Mat3 F;
    for (std::size_t a = 0; a < point.nodes.size(); ++a) F += outer(x[point.nodes[a]], point.g[a]);
    return F;
}

Mat3 transformation(const Body& body, const Stencil& point, const std::vector<double>& node_volume,
                    const std::vector<Vec3>& x) {
    Vec3 X_I, x_I;
    for (std::size_t a = 0; a < point.nodes.size(); ++a) {
        X_I += point.phi[a] * body.X[point.nodes[a]];
        x_I += point.phi[a] * x[point.nodes[a]];
    }
    Mat3 A;
    for (const std::size_t j : point.nodes) A += node_volume[j] * outer(x[j] - x_I, body.X[j] - X_I);
    return A;
}

Mat3 rotation_factor(const Mat3& A) {
    // Newton's method for R^T R = I, scaled to unit size first (Higham, SIAM J. Sci. Stat. Comput. 7, 1986, 1160).
    assert(determinant(A) > 0);
    Mat3 R = 1 / std::cbrt(determinant(A)) * A;
    for (int iteration = 0; iteration < 50; ++iteration) {
        const Mat3 next = 0.5 * (R + 1 / determinant(R) * cofactor(R));
        const double change = norm(next - R);
        R = next;
        if (change < 1e-15) break;
    }
    return R;
}

std::vector<Mat3> rotations(const Body& body, const std::vector<Vec3>& x, Rotation rotation) {
    const std::vector<double> volumes = node_volumes(body);
    std::vector<Mat3> R;
    for (const Stencil& point : body.points)
        R.push_back(rotation_factor(rotation == Rotation::printed ? transformation(body, point, volumes, x)
                                                                  : deformation_gradient(point, x)));
    return R;
}

std::vector<Vec3> forces(const Body& body, const std::vector<Vec3>& x, Rotation rotation) {
    const std::vector<Mat3> R = rotations(body, x, rotation);
    std::vector<Vec3> f(x.size());
    for (std::size_t I = 0; I < R.size(); ++I) {
        const Stencil& point = body.points[I];
        const Six sigma = stress(body, corotated_strain(body, point, x, R[I]));
        for (std::size_t a = 0; a < point.nodes.size(); ++a)
            f[point.nodes[a]] -= point.volume * (R[I] * pull(point.g[a], sigma));
    }
    return f;
}

double energy(const Body& body, const std::vector<Vec3>& x) {
    double U = 0;
    for (const Stencil& point : body.points) {
        const Mat3 R = rotation_factor(deformation_gradient(point, x));
        const Six eps = corotated_strain(body, point, x, R), sigma = stress(body, eps);
        for (std::size_t k = 0; k < 6; ++k) U += 0.5 * point.volume * sigma[k] * eps[k];
    }
    return U;
}

Mat3 tangent_block(const Body& body, const Stencil& point, std::size_t a, std::size_t b, const Mat3& R) {
    Vec3 columns[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // Column `axis` of R^T is how the turned frame sees a movement along that axis.
        const Six sigma = stress(body, strain(point.g[b], transpose(R).column(axis)));
        columns[axis] = point.volume * (R * pull(point.g[a], sigma));
    }
    return Mat3::from_columns(columns[0], columns[1], columns[2]);
}

}  // namespace phyxel::reference::brunet
