#pragma once

#include "phyxel/vector.h"

namespace phyxel {

/// A = U diag(values) V^T with rotations U and V (both of determinant +1), so that a reflection in A shows as a
/// negative last value: values.x >= values.y >= |values.z|, and their product is det A.
struct Svd3 {
    Mat3 U;
    Vec3 values;
    Mat3 V;
};

/// Rotation-variant singular value decomposition of any finite 3x3 matrix by one-sided Jacobi rotations (Hestenes;
/// Golub and Van Loan, Matrix Computations, section 8.6): accurate to rounding relative to the largest value also where
/// A^T A would lose half of the digits; zero, rank-deficient and repeated values are fine.
Svd3 rotation_variant_svd(const Mat3& A);

}  // namespace phyxel
