#pragma once

#include <cmath>
#include <cstddef>

/// Three-component vectors and 3x3 matrices: plain aggregates, laid out as their components and nothing else,
/// so that a span of them can be handed to a graphics card or to numpy as it is.

namespace phyxel {

/// A vector of three components; `Vec3{1, 2, 3}`.
template <class T>
struct Vec3T {
    T x{}, y{}, z{};

    constexpr T& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr const T& operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

    constexpr Vec3T& operator+=(const Vec3T& b) { return x += b.x, y += b.y, z += b.z, *this; }
    constexpr Vec3T& operator-=(const Vec3T& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
    constexpr Vec3T& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
    constexpr Vec3T& operator/=(T s) { return x /= s, y /= s, z /= s, *this; }

    friend constexpr Vec3T operator+(Vec3T a, const Vec3T& b) { return a += b; }
    friend constexpr Vec3T operator-(Vec3T a, const Vec3T& b) { return a -= b; }
    friend constexpr Vec3T operator-(const Vec3T& a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3T operator*(Vec3T a, T s) { return a *= s; }
    friend constexpr Vec3T operator*(T s, Vec3T a) { return a *= s; }
    friend constexpr Vec3T operator/(Vec3T a, T s) { return a /= s; }
    friend constexpr bool operator==(const Vec3T&, const Vec3T&) = default;
};

using Vec3 = Vec3T<double>;
using Vec3f = Vec3T<float>;

template <class T>
constexpr T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr T norm_squared(const Vec3T<T>& a) {
    return dot(a, a);
}

template <class T>
T norm(const Vec3T<T>& a) {
    return std::sqrt(dot(a, a));
}

/// `a` divided by its length; a zero vector stays zero.
template <class T>
Vec3T<T> normalized(const Vec3T<T>& a) {
    const T length = norm(a);
    return length > T(0) ? a / length : a;
}

template <class T>
bool is_finite(const Vec3T<T>& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

template <class To, class From>
constexpr Vec3T<To> vector_cast(const Vec3T<From>& a) {
    return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}

/// A 3x3 matrix, row by row; `A(row, column)`.
template <class T>
struct Mat3T {
    Vec3T<T> rows[3]{};

    static constexpr Mat3T identity() { return diagonal({T(1), T(1), T(1)}); }
    static constexpr Mat3T diagonal(const Vec3T<T>& d) {
        return {{{d.x, T(0), T(0)}, {T(0), d.y, T(0)}, {T(0), T(0), d.z}}};
    }
    static constexpr Mat3T from_columns(const Vec3T<T>& a, const Vec3T<T>& b, const Vec3T<T>& c) {
        return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
    }

    constexpr T& operator()(std::size_t row, std::size_t column) { return rows[row][column]; }
    constexpr const T& operator()(std::size_t row, std::size_t column) const { return rows[row][column]; }
    constexpr Vec3T<T> column(std::size_t c) const { return {rows[0][c], rows[1][c], rows[2][c]}; }

    constexpr Mat3T& operator+=(const Mat3T& B) {
        for (int r = 0; r < 3; ++r) rows[r] += B.rows[r];
        return *this;
    }
    constexpr Mat3T& operator-=(const Mat3T& B) {
        for (int r = 0; r < 3; ++r) rows[r] -= B.rows[r];
        return *this;
    }
    constexpr Mat3T& operator*=(T s) {
        for (auto& row : rows) row *= s;
        return *this;
    }

    friend constexpr Mat3T operator+(Mat3T A, const Mat3T& B) { return A += B; }
    friend constexpr Mat3T operator-(Mat3T A, const Mat3T& B) { return A -= B; }
    friend constexpr Mat3T operator*(Mat3T A, T s) { return A *= s; }
    friend constexpr Mat3T operator*(T s, Mat3T A) { return A *= s; }
    friend constexpr Vec3T<T> operator*(const Mat3T& A, const Vec3T<T>& v) {
        return {dot(A.rows[0], v), dot(A.rows[1], v), dot(A.rows[2], v)};
    }
    friend constexpr Mat3T operator*(const Mat3T& A, const Mat3T& B) {
        Mat3T C;
        for (int r = 0; r < 3; ++r)
            C.rows[r] = A.rows[r].x * B.rows[0] + A.rows[r].y * B.rows[1] + A.rows[r].z * B.rows[2];
        return C;
    }
    friend constexpr bool operator==(const Mat3T& A, const Mat3T& B) {
        return A.rows[0] == B.rows[0] && A.rows[1] == B.rows[1] && A.rows[2] == B.rows[2];
    }
};

using Mat3 = Mat3T<double>;
using Mat3f = Mat3T<float>;

template <class T>
constexpr Mat3T<T> transpose(const Mat3T<T>& A) {
    return {{A.column(0), A.column(1), A.column(2)}};
}

template <class T>
constexpr T trace(const Mat3T<T>& A) {
    return A(0, 0) + A(1, 1) + A(2, 2);
}

template <class T>
constexpr T determinant(const Mat3T<T>& A) {
    return dot(A.rows[0], cross(A.rows[1], A.rows[2]));
}

/// Cofactor matrix, the derivative of the determinant: cof(A) = det(A) A^-T wherever A is invertible.
template <class T>
constexpr Mat3T<T> cofactor(const Mat3T<T>& A) {
    return {{cross(A.rows[1], A.rows[2]), cross(A.rows[2], A.rows[0]), cross(A.rows[0], A.rows[1])}};
}

/// Inverse by the cofactors; the caller knows that `A` is invertible.
template <class T>
constexpr Mat3T<T> inverse(const Mat3T<T>& A) {
    return transpose(cofactor(A)) * (T(1) / determinant(A));
}

/// Outer product a b^T.
template <class T>
constexpr Mat3T<T> outer(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {{a.x * b, a.y * b, a.z * b}};
}

/// Double contraction A : B.
template <class T>
constexpr T contract(const Mat3T<T>& A, const Mat3T<T>& B) {
    return dot(A.rows[0], B.rows[0]) + dot(A.rows[1], B.rows[1]) + dot(A.rows[2], B.rows[2]);
}

/// Frobenius norm.
template <class T>
T norm(const Mat3T<T>& A) {
    return std::sqrt(contract(A, A));
}

/// Rotation by `radians` about the unit vector `axis` (Rodrigues' formula).
inline Mat3 rotation_about(const Vec3& axis, double radians) {
    const double c = std::cos(radians), s = std::sin(radians);
    const Mat3 K = {{{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}}};
    return c * Mat3::identity() + s * K + (1 - c) * outer(axis, axis);
}

}  // namespace phyxel
