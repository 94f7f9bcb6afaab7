#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cstddef>
#include <vector>

#include "phyxel/vector.h"
#include "reference/fem/solid.h"

/// The sparse matrices of a solid over its free coordinates.

namespace phyxel::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// L D L^T in the order of the nodes: with z the longest side the band is narrow, and narrow bands of 8-node hexahedra
/// are five times faster to eliminate than what minimum degree makes of them; 27-node ones a fifth slower.
using Solver = Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::NaturalOrdering<int>>;

/// Lower triangles of the stiffness and mass matrices over the free coordinates, with their shared sparsity and the
/// order of its elimination: made once, used in every Newton iteration. The solid must outlive it.
class System {
public:
    /// The forces may change later through `conditions.force`; what is fixed may not.
    System(const Solid& solid, const Conditions& conditions);

    const Solid& solid;
    Conditions conditions;

    /// Number of free coordinates.
    Eigen::Index size() const { return size_; }

    /// [free] the free coordinates of nodal vectors [nodes].
    Eigen::VectorXd gather(const std::vector<Vec3>& nodal) const;

    /// Adds `step` [free] to the free coordinates of x [nodes].
    void add(const Eigen::VectorXd& step, std::vector<Vec3>& x) const;

    /// K(x), second derivative of the elastic energy [N/m]: exact, with the turning of R in the corotated law. Lower
    /// half.
    SparseMatrix stiffness(const std::vector<Vec3>& x) const;

    /// Consistent mass matrix [kg], the same for x, y and z. Lower half.
    const SparseMatrix& mass() const { return mass_; }

    /// The solver, prepared for this sparsity.
    Solver& solver() { return solver_; }

private:
    std::vector<Eigen::Index> free_;  // [3 nodes] number among the free coordinates, or -1
    Eigen::Index size_ = 0;
    SparseMatrix pattern_;  // zeros
    SparseMatrix mass_;
    Solver solver_;

    SparseMatrix pattern() const;
    SparseMatrix consistent_mass() const;
    void add_block(std::size_t i, std::size_t j, const Mat3& block, SparseMatrix& A) const;
};

}  // namespace phyxel::fem
