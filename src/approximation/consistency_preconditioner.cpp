#include "approximation/consistency_preconditioner.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <array>
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

/// Cholesky factor of D S_bb D + shift with D = diag(S_bb)^-1/2, in single precision: it only has to be roughly right.
struct LocalFactor {
    Eigen::MatrixXf lower;
    Eigen::VectorXd scale;  // D

    void factor(const ConsistencyMatrix& S, const Block& block) {
        const auto n = static_cast<Eigen::Index>(block.end - block.begin);
        scale.resize(n);
        for (std::uint32_t i = block.begin; i < block.end; ++i)
            scale[i - block.begin] = S.diagonal[i] > 0 ? 1 / std::sqrt(S.diagonal[i]) : 0;
        Eigen::MatrixXf scaled = Eigen::MatrixXf::Zero(n, n);
        for (std::uint32_t i = block.begin; i < block.end; ++i)
            for (std::size_t e = S.row[i]; e < S.row[i + 1] && S.column[e] < i; ++e)
                if (S.column[e] >= block.begin) {
                    const auto row = i - block.begin, column = S.column[e] - block.begin;
                    scaled(row, column) = static_cast<float>(scale[row] * S.value[e] * scale[column]);
                }
        for (float shift = local_shift;; shift *= 10) {
            lower = scaled;
            lower.diagonal().setConstant(1 + shift);
            const Eigen::LLT<Eigen::Ref<Eigen::MatrixXf>> cholesky(lower);
            if (cholesky.info() == Eigen::Success) return;
        }
    }

    Eigen::MatrixX3d solve(const Eigen::MatrixX3d& b) const {
        Eigen::MatrixX3f x = (scale.asDiagonal() * b).cast<float>();
        lower.triangularView<Eigen::Lower>().solveInPlace(x);
        lower.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
        return scale.asDiagonal() * x.cast<double>();
    }
};

/// The coarse problem Z^T S Z, Z the orthonormal linear functions of each block.
class Coarse {
public:
    void build(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, const Threads& threads);

    Eigen::Index size() const { return scale_.size(); }
    /// (4, nodes) values of the four functions of `block`.
    auto functions(const Block& block) const { return values_.middleCols(block.begin, block.end - block.begin); }

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
        const std::vector<double> ones(block.end - block.begin, 1.0);
        const LinearFit fit = fit_linear(std::span(blocks.position).subspan(block.begin, ones.size()), ones);
        for (std::uint32_t i = block.begin; i < block.end; ++i) {
            block_of[i] = static_cast<std::uint32_t>(b);
            for (std::size_t k = 0; k < 4; ++k) values_(static_cast<int>(k), i) = fit(k, blocks.position[i]);
            energy_of_diagonal.segment<4>(static_cast<Eigen::Index>(4 * b)) +=
                S.diagonal[i] * values_.col(i).cwiseAbs2();
        }
    });

    // lower triangle of Z^T S Z, the rows of one block after another
    using Triplet = Eigen::Triplet<double, Eigen::Index>;
    std::vector<std::vector<Triplet>> triplets(count);
    threads.for_chunks(count, blocks_a_chunk, [&](std::size_t chunk_begin, std::size_t chunk_end) {
        std::vector<Eigen::Matrix4d> product(count, Eigen::Matrix4d::Zero());
        std::vector<char> met(count, 0);
        std::vector<std::uint32_t> meets;
        for (std::size_t b = chunk_begin; b < chunk_end; ++b) {
            meets.clear();
            for (std::uint32_t i = blocks.blocks[b].begin; i < blocks.blocks[b].end; ++i)
                for (std::size_t e = S.row[i]; e < S.row[i + 1] && S.column[e] < blocks.blocks[b].end;) {
                    const std::uint32_t other = block_of[S.column[e]];
                    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
                    for (; e < S.row[i + 1] && S.column[e] < blocks.blocks[other].end; ++e)
                        sum += S.value[e] * values_.col(S.column[e]);
                    if (!met[other]) met[other] = 1, meets.push_back(other);
                    product[other] += values_.col(i) * sum.transpose();
                }
            for (const std::uint32_t other : meets) {
                for (Eigen::Index r = 0; r < 4; ++r)
                    for (Eigen::Index c = 0; c < (other == b ? r + 1 : 4); ++c)
                        triplets[b].emplace_back(static_cast<Eigen::Index>(4 * b) + r, 4 * Eigen::Index(other) + c,
                                                 product[other](r, c));
                met[other] = 0;
                product[other].setZero();
            }
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
    std::vector<LocalFactor> local;  // [blocks]
    Coarse coarse;
    Eigen::MatrixX3d moments;  // (4 blocks, 3)
};

ConsistencyPreconditioner::ConsistencyPreconditioner(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks,
                                                     const Threads& threads)
    : parts_(new Parts{blocks, std::vector<LocalFactor>(blocks.blocks.size()), {}, {}}) {
    threads.for_each(blocks.blocks.size(), 1, [&](std::size_t b) { parts_->local[b].factor(S, blocks.blocks[b]); });
    parts_->coarse.build(S, blocks, threads);
    parts_->moments.resize(parts_->coarse.size(), 3);
}

ConsistencyPreconditioner::~ConsistencyPreconditioner() = default;

void ConsistencyPreconditioner::apply(std::span<const Vec3> r, std::span<Vec3> z, const Threads& threads) {
    using Columns = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
    Parts& parts = *parts_;
    const auto columns = [](std::span<const Vec3> v, const Block& block) {
        return Columns(&v[block.begin].x, block.end - block.begin, 3);
    };
    threads.for_each(parts.blocks.blocks.size(), blocks_a_chunk, [&](std::size_t b) {
        const Block& block = parts.blocks.blocks[b];
        parts.moments.middleRows<4>(static_cast<Eigen::Index>(4 * b)).noalias() =
            parts.coarse.functions(block) * columns(r, block);
    });
    parts.coarse.solve(parts.moments);
    threads.for_each(parts.blocks.blocks.size(), blocks_a_chunk, [&](std::size_t b) {
        const Block& block = parts.blocks.blocks[b];
        Eigen::MatrixX3d x = parts.local[b].solve(columns(r, block));
        x += coarse_factor * (parts.coarse.functions(block).transpose() *
                              parts.moments.middleRows<4>(static_cast<Eigen::Index>(4 * b)));
        for (std::uint32_t i = block.begin; i < block.end; ++i) {
            const Eigen::Index k = i - block.begin;
            z[i] = {x(k, 0), x(k, 1), x(k, 2)};
        }
    });
}

}  // namespace phyxel
