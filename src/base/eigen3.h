#pragma once

#include "phyxel/vector.h"

/// Eigenvalues and eigenvectors of symmetric 3x3 matrices.

namespace phyxel {

/// A symmetric matrix as `vectors * diag(values) * vectors^T`.
struct SymmetricEigen3 {
    Vec3 values;   ///< ascending
    Mat3 vectors;  ///< orthonormal columns in the order of the values, det = +1
};

/// Eigenvalues and eigenvectors of the symmetric part of `A` by cyclic Jacobi rotations: each eigenvalue to a few
/// units of rounding of the largest one, the vectors orthonormal to rounding, repeated and zero eigenvalues included.
/// `A` must be finite. (Golub and Van Loan, Matrix Computations, section 8.5.)
SymmetricEigen3 symmetric_eigen(const Mat3& A);

}  // namespace phyxel
