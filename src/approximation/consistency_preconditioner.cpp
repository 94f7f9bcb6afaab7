#include "approximation/consistency_preconditioner.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace phyxel {

namespace {

using Block = ConsistencyBlocks::Block;

/// Added to a unit diagonal before a factorization, so that a null space does not stop it: small, but far above the
/// rounding of the precision used. Only the number of iterations depends on it.
constexpr float local_shift = 1e-5f;
constexpr double coarse_shift = 1e-8;
/// The coarse part counts this much; measured, flat from 1 to 8.
constexpr double coarse_factor = 2;
/// Coarse functions with less energy than this, in units of the diagonal's, are in the null space.
constexpr double negligible_energy = 1e-10;
/// Coarse systems up to this size are factored as dense matrices.
constexpr Eigen::Index dense_coarse_limit = 1500;
constexpr std::size_t blocks_a_chunk = 16;

/// (S_bb + shift)^-1 by a Cholesky factor of D S_bb D + shift with D = diag(S_bb)^-1/2, in single precision: it only
/// has to be roughly right.
Panel local_inverse(const ConsistencyMatrix& S, const ConsistencyMatrix::Rows& rows, const Block& block) {
    const auto n = static_cast<Eigen::Index>(block.end - block.begin);
    Eigen::VectorXf scale(n);
    for (std::uint32_t i = block.begin; i < block.end; ++i)
        scale[i - block.begin] = S.diagonal[i] > 0 ? static_cast<float>(1 / std::sqrt(S.diagonal[i])) : 0;
    Eigen::MatrixXf scaled = Eigen::MatrixXf::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < i; ++j)
            scaled(i, j) = scale[i] * scale[j] *
                           rows.value.at(static_cast<std::size_t>(i), rows.own + static_cast<std::size_t>(j));
    Eigen::MatrixXf inverse;
    for (float shift = local_shift;; shift *= 10) {
        scaled.diagonal().setConstant(1 + shift);
        const Eigen::LLT<Eigen::MatrixXf> cholesky(scaled);
        if (cholesky.info() != Eigen::Success) continue;
        inverse = cholesky.solve(Eigen::MatrixXf::Identity(n, n));
        break;
    }
    Panel panel(static_cast<std::size_t>(n), static_cast<std::size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            panel.row(static_cast<std::size_t>(i))[static_cast<std::size_t>(j) * Panel::group] =
                scale[i] * scale[j] * inverse(std::max(i, j), std::min(i, j));
    return panel;
}

/// The coarse problem Z^T S Z, Z the orthonormal linear functions of each block.
class Coarse {
public:
    void build(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, const Threads& threads);

    Eigen::Index size() const { return scale_.size(); }
    /// (4, nodes) values of the four functions of `block`.
    auto functions(const Block& block) const { return values_.middleCols(block.begin, block.end - block.begin); }

    /// (4) values at node i.
    auto function(std::uint32_t i) const { return values_.col(i); }

    /// right-hand side and solution: rows 4 b to 4 b + 3 belong to block b
    void solve(Eigen::MatrixX3d& c) const {
        c = scale_.asDiagonal() * c;
        if (size() <= dense_coarse_limit) dense_.solveInPlace(c);
        else c = Eigen::MatrixX3d(sparse_.solve(c));
        c = scale_.asDiagonal() * c;
    }

private:
    void factor(Eigen::SparseMatrix<double> A, const Eigen::VectorXd& energy_of_diagonal);

    Eigen::Matrix4Xd values_;  // (4, zone nodes)
    Eigen::VectorXd scale_;    // [4 blocks], 0 for functions that do not count
    Eigen::LLT<Eigen::MatrixXd> dense_;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> sparse_;
};

void Coarse::build(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, const Threads& threads) {
    const std::size_t count = blocks.blocks.size();
    values_.resize(4, static_cast<Eigen::Index>(blocks.size()));
    Eigen::VectorXd energy_of_diagonal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(4 * count));
    std::vector<std::uint32_t> block_of(blocks.size());
    threads.for_each(count, blocks_a_chunk, [&](std::size_t b) {
        const Block& block = blocks.blocks[b];
        for (std::uint32_t i = block.begin; i < block.end; ++i) {
            block_of[i] = static_cast<std::uint32_t>(b);
            for (std::size_t k = 0; k < 4; ++k)
                values_(static_cast<int>(k), i) = blocks.linear[b](k, blocks.position[i]);
            energy_of_diagonal.segment<4>(static_cast<Eigen::Index>(4 * b)) +=
                S.diagonal[i] * values_.col(i).cwiseAbs2();
        }
    });

    // lower triangle of Z^T S Z, the rows of one block after another
    using Triplet = Eigen::Triplet<double, Eigen::Index>;
    std::vector<std::vector<Triplet>> triplets(count);
    threads.for_each(count, blocks_a_chunk, [&](std::size_t b) {
        const auto& [column, own, value] = S.rows[b];
        const std::size_t rows = value.rows();
        for (std::size_t e = 0; e < own + rows;) {
            const std::uint32_t other = block_of[column[e]];
            Eigen::Matrix4d product = Eigen::Matrix4d::Zero();
            for (; e < column.size() && column[e] < blocks.blocks[other].end; ++e) {
                Eigen::Vector4d sum = Eigen::Vector4d::Zero();
                for (std::size_t i = 0; i < rows; ++i)
                    sum += static_cast<double>(value.at(i, e)) * values_.col(blocks.blocks[b].begin + i);
                product += sum * values_.col(column[e]).transpose();
            }
            for (Eigen::Index r = 0; r < 4; ++r)
                for (Eigen::Index c = 0; c < (other == b ? r + 1 : 4); ++c)
                    triplets[b].emplace_back(static_cast<Eigen::Index>(4 * b) + r, 4 * Eigen::Index(other) + c,
                                             product(r, c));
        }
    });
    std::vector<Triplet> all;
    for (const auto& t : triplets) all.insert(all.end(), t.begin(), t.end());
    Eigen::SparseMatrix<double> A(energy_of_diagonal.size(), energy_of_diagonal.size());
    A.setFromTriplets(all.begin(), all.end());
    factor(std::move(A), energy_of_diagonal);
}

void Coarse::factor(Eigen::SparseMatrix<double> A, const Eigen::VectorXd& energy_of_diagonal) {
    scale_ = A.diagonal();
    for (Eigen::Index k = 0; k < size(); ++k)
        scale_[k] = scale_[k] > negligible_energy * energy_of_diagonal[k] ? 1 / std::sqrt(scale_[k]) : 0;
    A = scale_.asDiagonal() * A * scale_.asDiagonal();
    for (double shift = coarse_shift;; shift *= 10) {
        for (Eigen::Index k = 0; k < size(); ++k) A.coeffRef(k, k) = 1 + shift;
        if (size() <= dense_coarse_limit) dense_.compute(Eigen::MatrixXd(A));
        else sparse_.compute(A);
        if ((size() <= dense_coarse_limit ? dense_.info() : sparse_.info()) == Eigen::Success) return;
    }
}

}  // namespace

struct ConsistencyPreconditioner::Parts {
    const ConsistencyBlocks& blocks;
    std::vector<Panel> local;  // [blocks]
    Coarse coarse;
    Eigen::MatrixX3d moments;  // (4 blocks, 3)
};

ConsistencyPreconditioner::ConsistencyPreconditioner(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks,
                                                     const Threads& threads)
    : parts_(new Parts{blocks, std::vector<Panel>(blocks.blocks.size()), {}, {}}) {
    threads.for_each(blocks.blocks.size(), 1,
                     [&](std::size_t b) { parts_->local[b] = local_inverse(S, S.rows[b], blocks.blocks[b]); });
    parts_->coarse.build(S, blocks, threads);
    parts_->moments.resize(parts_->coarse.size(), 3);
}

ConsistencyPreconditioner::~ConsistencyPreconditioner() = default;

void ConsistencyPreconditioner::apply(std::span<const Vec3> r, std::span<Vec3> z, const Threads& threads) {
    using Columns = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
    Parts& parts = *parts_;
    threads.for_each(parts.blocks.blocks.size(), blocks_a_chunk, [&](std::size_t b) {
        const Block& block = parts.blocks.blocks[b];
        parts.moments.middleRows<4>(static_cast<Eigen::Index>(4 * b)).noalias() =
            parts.coarse.functions(block) * Columns(&r[block.begin].x, block.end - block.begin, 3);
    });
    parts.coarse.solve(parts.moments);
    threads.for_chunks(parts.blocks.blocks.size(), blocks_a_chunk, [&](std::size_t chunk_begin, std::size_t chunk_end) {
        std::vector<Vec3f> single, solved;
        for (std::size_t b = chunk_begin; b < chunk_end; ++b) {
            const auto [begin, end] = parts.blocks.blocks[b];
            single.clear();
            for (std::uint32_t i = begin; i < end; ++i) single.push_back(vector_cast<float>(r[i]));
            solved.resize(end - begin);
            parts.local[b].multiply(single, solved);
            const Eigen::Matrix<double, 4, 3> smooth =
                coarse_factor * parts.moments.middleRows<4>(static_cast<Eigen::Index>(4 * b));
            for (std::uint32_t i = begin; i < end; ++i) {
                const Eigen::RowVector3d s = parts.coarse.function(i).transpose() * smooth;
                z[i] = vector_cast<double>(solved[i - begin]) + Vec3{s[0], s[1], s[2]};
            }
        }
    });
}

}  // namespace phyxel
