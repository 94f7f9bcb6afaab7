#pragma once

#include <array>

#include "phyxel/vector.h"

namespace phyxel {

/// A 4x4 matrix as OpenGL takes it: single precision, column by column.
struct Mat4f {
    std::array<float, 16> values{};

    float& operator()(int row, int column) { return values[static_cast<std::size_t>(column * 4 + row)]; }
    float operator()(int row, int column) const { return values[static_cast<std::size_t>(column * 4 + row)]; }

    friend Mat4f operator*(const Mat4f& A, const Mat4f& B) {
        Mat4f C;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                for (int k = 0; k < 4; ++k) C(r, c) += A(r, k) * B(k, c);
        return C;
    }
};

/// x -> A x + b.
inline Mat4f affine(const Mat3& A, const Vec3& b) {
    Mat4f M;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) M(static_cast<int>(r), static_cast<int>(c)) = static_cast<float>(A(r, c));
        M(static_cast<int>(r), 3) = static_cast<float>(b[r]);
    }
    M(3, 3) = 1;
    return M;
}

/// World to eye space: the eye at the origin, `backward` (from what is looked at to the eye, unit) along z, `up` in the
/// half plane of y > 0.
inline Mat4f view_matrix(const Vec3& eye, const Vec3& backward, const Vec3& up) {
    const Vec3 right = normalized(cross(up, backward));
    const Mat3 R = {{right, cross(backward, right), backward}};
    return affine(R, -(R * eye));
}

/// Eye space to clip space, seen in perspective; `tangent` is that of half the vertical angle of view.
inline Mat4f perspective_matrix(double tangent, double aspect, double near, double far) {
    Mat4f M;
    M(0, 0) = static_cast<float>(1 / (tangent * aspect));
    M(1, 1) = static_cast<float>(1 / tangent);
    M(2, 2) = static_cast<float>((far + near) / (near - far));
    M(2, 3) = static_cast<float>(2 * far * near / (near - far));
    M(3, 2) = -1;
    return M;
}

/// Eye space to clip space, seen in parallel: |x|, |y| up to `half_width`, z from 0 down to -depth.
inline Mat4f parallel_matrix(double half_width, double depth) {
    return affine(Mat3::diagonal({1 / half_width, 1 / half_width, -2 / depth}), {0, 0, -1});
}

}  // namespace phyxel
