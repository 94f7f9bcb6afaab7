#include "solver/patch_rows.h"

#include <Eigen/SparseCholesky>
#include <map>

#include "solver/nodal_vectors.h"

namespace phyxel {

PatchRows::PatchRows(const Constraints& constraints, std::span<const Vec3> free) {
    for (const Constraints::Patch& patch : constraints.patches()) {
        for (std::size_t i = 0; i < patch.node.size(); ++i) {
            node_.push_back(patch.node[i]);
            coefficient_.push_back(patch.coefficient[i] * free[patch.node[i]]);
        }
        offset_.push_back(static_cast<std::uint32_t>(node_.size()));
        stiffness_.push_back(patch.stiffness);
    }
}

PatchRows PatchRows::coarsened(const Coarsening& coarse) const {
    PatchRows result;
    result.stiffness_ = stiffness_;
    const SparseRows& P = coarse.prolongation;
    for (std::size_t r = 0; r < stiffness_.size(); ++r) {
        std::map<std::uint32_t, Vec3> sum;
        for (std::uint32_t k = offset_[r]; k < offset_[r + 1]; ++k)
            for (std::uint32_t p = P.offset[node_[k]]; p < P.offset[node_[k] + 1]; ++p)
                sum[P.column[p]] += P.value[p] * coefficient_[k];
        for (const auto& [node, c] : sum) result.node_.push_back(node), result.coefficient_.push_back(c);
        result.offset_.push_back(static_cast<std::uint32_t>(result.node_.size()));
    }
    return result;
}

void PatchRows::add_action(const std::vector<Vec3f>& d, std::vector<Vec3f>& out) const {
    for (std::size_t r = 0; r < stiffness_.size(); ++r) {
        Vec3 moved{};
        for (std::uint32_t k = offset_[r]; k < offset_[r + 1]; ++k)
            moved += times(coefficient_[k], vector_cast<double>(d[node_[k]]));
        const Vec3 force = times(stiffness_[r], moved);
        for (std::uint32_t k = offset_[r]; k < offset_[r + 1]; ++k)
            out[node_[k]] += vector_cast<float>(times(coefficient_[k], force));
    }
}

void PatchRows::add_to(BlockRows& rows) const {
    for (std::size_t r = 0; r < stiffness_.size(); ++r)
        for (std::uint32_t a = offset_[r]; a < offset_[r + 1]; ++a)
            for (std::uint32_t b = offset_[r]; b < offset_[r + 1]; ++b)
                rows.add(node_[a], node_[b],
                         Mat3::diagonal(times(stiffness_[r], times(coefficient_[a], coefficient_[b]))));
}

struct BlockJacobi::Patches {
    PatchRows rows;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;  ///< of C D^-1 C^T + k^-1
    mutable Eigen::VectorXd moved;
};

BlockJacobi::BlockJacobi() = default;
BlockJacobi::~BlockJacobi() = default;
BlockJacobi::BlockJacobi(BlockJacobi&&) noexcept = default;
BlockJacobi& BlockJacobi::operator=(BlockJacobi&&) noexcept = default;

BlockJacobi::BlockJacobi(std::span<const Mat3> diagonal, const PatchRows& patches) {
    // Components without any stiffness, held ones among them, stay where they are.
    std::vector<Mat3> inverses;
    for (const Mat3& D : diagonal) {
        Mat3 A = D;
        Vec3 live{1, 1, 1};
        for (std::size_t d = 0; d < 3; ++d)
            if (!(D(d, d) > 0)) A(d, d) = 1, live[d] = 0;
        Mat3 inverted = inverse(A);
        for (std::size_t d = 0; d < 3; ++d)
            if (live[d] == 0) inverted(d, d) = 0;
        inverses.push_back(inverted);
        inverse_.push_back(to_float(inverted));
    }
    if (patches.empty()) return;
    patches_ = std::make_unique<Patches>();
    patches_->rows = patches;
    const auto rows = static_cast<int>(patches.stiffness_.size());
    std::vector<Eigen::Triplet<double>> entries, inner_entries;
    for (int r = 0; r < rows; ++r)
        for (std::uint32_t k = patches.offset_[r]; k < patches.offset_[r + 1]; ++k)
            for (int d = 0; d < 3; ++d)
                entries.emplace_back(3 * r + d, 3 * static_cast<int>(patches.node_[k]) + d, patches.coefficient_[k][d]);
    for (std::uint32_t i : patches.node_)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                inner_entries.emplace_back(3 * static_cast<int>(i) + a, 3 * static_cast<int>(i) + b, inverses[i](a, b));
    const auto size = 3 * static_cast<int>(diagonal.size());
    Eigen::SparseMatrix<double> C(3 * rows, size), D_inverse(size, size);
    C.setFromTriplets(entries.begin(), entries.end());
    D_inverse.setFromTriplets(inner_entries.begin(), inner_entries.end(), [](double first, double) { return first; });
    Eigen::SparseMatrix<double> G = C * D_inverse * C.transpose();
    // A direction in which a patch may slide has no stiffness: its multiplier is nothing.
    for (int r = 0; r < rows; ++r)
        for (int d = 0; d < 3; ++d) {
            const double k = patches.stiffness_[r][d];
            G.coeffRef(3 * r + d, 3 * r + d) += k > 0 ? 1 / k : 1e300;
        }
    patches_->factor.compute(G);
    patches_->moved.resize(3 * rows);
}

void BlockJacobi::apply(const std::vector<Vec3f>& r, std::vector<Vec3f>& z, const Threads& threads) const {
    threads.for_each(r.size(), node_chunk, [&](std::size_t i) { z[i] = inverse_[i] * r[i]; });
    if (!patches_) return;
    const PatchRows& rows = patches_->rows;
    for (std::size_t row = 0; row < rows.stiffness_.size(); ++row) {
        Vec3 moved{};
        for (std::uint32_t k = rows.offset_[row]; k < rows.offset_[row + 1]; ++k)
            moved += times(rows.coefficient_[k], vector_cast<double>(z[rows.node_[k]]));
        for (std::size_t d = 0; d < 3; ++d) patches_->moved[static_cast<Eigen::Index>(3 * row + d)] = moved[d];
    }
    const Eigen::VectorXd multiplier = patches_->factor.solve(patches_->moved);
    for (std::size_t row = 0; row < rows.stiffness_.size(); ++row) {
        const auto at = static_cast<Eigen::Index>(3 * row);
        const Vec3 force{multiplier[at], multiplier[at + 1], multiplier[at + 2]};
        for (std::uint32_t k = rows.offset_[row]; k < rows.offset_[row + 1]; ++k)
            z[rows.node_[k]] -= inverse_[rows.node_[k]] * vector_cast<float>(times(rows.coefficient_[k], force));
    }
}

}  // namespace phyxel
