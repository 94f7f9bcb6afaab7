#include "approximation/consistency_preconditioner.h"

#define EIGEN_MPL2_ONLY
#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace phyxel {

namespace {

using Block = ConsistencyBlocks::Block;

/// Added to a unit diagonal before a factorization, so that the null space does not stop it: as little as the precision
/// allows. Only the number of iterations depends on it.
constexpr float local_shift = 1e-5f;
constexpr double coarse_shift = 1e-8;
/// A coarse function that is so nearly a combination of its block's others is left out.
constexpr double negligible_function = 1e-3;
/// Coarse systems up to this size are factored as dense matrices.
constexpr Eigen::Index dense_coarse_limit = 2000;

/// Cholesky factor of D (S_bb + shift) D with D = diag(S_bb)^-1/2, in single precision: it only has to be roughly
/// right.
struct LocalFactor {
    Eigen::MatrixXf lower;
    std::vector<double> scale;  // D

    void factor(const ConsistencyMatrix& S, std::span<const std::uint32_t> nodes, std::vector<std::uint32_t>& local) {
        const auto n = static_cast<Eigen::Index>(nodes.size());
        scale.resize(nodes.size());
        for (std::uint32_t k = 0; k < nodes.size(); ++k) {
            local[nodes[k]] = k;
            const double d = S.diagonal[nodes[k]];
            scale[k] = d > 0 ? 1 / std::sqrt(d) : 0;
        }
        Eigen::MatrixXf scaled = Eigen::MatrixXf::Zero(n, n);
        for (std::uint32_t k = 0; k < nodes.size(); ++k)
            for (std::size_t e = S.row[nodes[k]]; e < S.row[nodes[k] + 1]; ++e)
                if (const std::uint32_t l = local[S.column[e]]; l < k)
                    scaled(k, l) = static_cast<float>(scale[k] * S.value[e] * scale[l]);
        for (const std::uint32_t i : nodes) local[i] = ConsistencyBlocks::none;

        for (float shift = local_shift;; shift *= 10) {
            lower = scaled;
            lower.diagonal().setConstant(1 + shift);
            Eigen::LLT<Eigen::Ref<Eigen::MatrixXf>> cholesky(lower);
            if (cholesky.info() == Eigen::Success) return;
        }
    }

    void solve(Eigen::Ref<Eigen::MatrixXf> x) const {
        lower.triangularView<Eigen::Lower>().solveInPlace(x);
        lower.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    }
};

/// Smooth step from 0 at t <= 0 to 1 at t >= 1, with zero slope at both ends.
double smooth_step(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// How much of node X a block takes before all are made to sum to one: 1 well inside its box, 0 at the overlap's end.
double fade(const Block& block, const Vec3& X, double overlap) {
    double result = 1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double inside = std::min(X[k] - block.low[k], block.high[k] - X[k]);
        result *= smooth_step((inside + overlap) / (2 * overlap));
    }
    return std::max(result, 1e-6);
}

/// The faded linear functions of one block, orthonormal; fewer than four where its nodes are few.
Eigen::MatrixXd coarse_functions(const Block& block, const ConsistencyBlocks& blocks, std::span<const double> fade_sum,
                                 double overlap) {
    const auto n = static_cast<Eigen::Index>(block.extended.size());
    Eigen::MatrixXd Z(n, 4);
    const Vec3 centre = 0.5 * (block.low + block.high);
    for (Eigen::Index k = 0; k < n; ++k) {
        const std::uint32_t i = block.extended[static_cast<std::size_t>(k)];
        const Vec3 X = blocks.position[i];
        const double f = fade(block, X, overlap) / fade_sum[i];
        const Vec3 e = (X - centre) / overlap;
        Z.row(k) << f, f * e.x, f * e.y, f * e.z;
    }
    Eigen::Index kept = 0;
    for (Eigen::Index c = 0; c < 4; ++c) {
        Eigen::VectorXd z = Z.col(c);
        const double before = z.norm();
        for (int pass = 0; pass < 2; ++pass)
            for (Eigen::Index l = 0; l < kept; ++l) z -= Z.col(l).dot(z) * Z.col(l);
        if (z.norm() > negligible_function * before) Z.col(kept++) = z.normalized();
    }
    return Z.leftCols(kept);
}

}  // namespace

struct ConsistencyPreconditioner::Parts {
    explicit Parts(const ConsistencyBlocks& all) : blocks(all) {}

    const ConsistencyBlocks& blocks;
    std::vector<LocalFactor> local;                   // [blocks]
    std::vector<Eigen::MatrixXf> answer;              // [blocks] (extended nodes, 3)
    std::vector<std::size_t> place_offset;            // [zone nodes + 1]
    std::vector<std::array<std::uint32_t, 2>> place;  // block and row in it, for each block that holds a node

    std::vector<Eigen::MatrixXd> functions;    // [blocks] (extended nodes, coarse functions of the block)
    std::vector<Eigen::Index> first_function;  // [blocks + 1]
    Eigen::VectorXd coarse_scale;
    Eigen::LLT<Eigen::MatrixXd> coarse_dense;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> coarse_sparse;
    Eigen::MatrixXd coarse;  // (coarse functions, 3)

    void find_places();
    void build_coarse(const ConsistencyMatrix& S, double overlap, const Threads& threads);
    void solve_coarse(std::span<const Vec3> r, const Threads& threads);
    Eigen::Index coarse_size() const { return first_function.back(); }
};

void ConsistencyPreconditioner::Parts::find_places() {
    place_offset.assign(blocks.size() + 1, 0);
    for (const Block& block : blocks.blocks)
        for (const std::uint32_t i : block.extended) ++place_offset[i + 1];
    for (std::size_t i = 0; i < blocks.size(); ++i) place_offset[i + 1] += place_offset[i];
    place.resize(place_offset.back());
    std::vector<std::size_t> next(place_offset.begin(), place_offset.end() - 1);
    for (std::uint32_t b = 0; b < blocks.blocks.size(); ++b)
        for (std::uint32_t k = 0; k < blocks.blocks[b].extended.size(); ++k)
            place[next[blocks.blocks[b].extended[k]]++] = {b, k};
}

/// A_c = Z^T S Z, block column by block column.
void ConsistencyPreconditioner::Parts::build_coarse(const ConsistencyMatrix& S, double overlap,
                                                    const Threads& threads) {
    std::vector<double> fade_sum(blocks.size(), 0.0);
    threads.for_each(blocks.size(), 1024, [&](std::size_t i) {
        for (std::size_t p = place_offset[i]; p < place_offset[i + 1]; ++p)
            fade_sum[i] += fade(blocks.blocks[place[p][0]], blocks.position[i], overlap);
    });
    functions.resize(blocks.blocks.size());
    threads.for_each(blocks.blocks.size(), 8, [&](std::size_t b) {
        // a part of one block has its exact inverse
        const Block& block = blocks.blocks[b];
        if (blocks.blocks_in_component[block.component] > 1)
            functions[b] = coarse_functions(block, blocks, fade_sum, overlap);
    });
    first_function.assign(1, 0);
    for (const Eigen::MatrixXd& f : functions) first_function.push_back(first_function.back() + f.cols());
    if (coarse_size() == 0) return;

    using Triplet = Eigen::Triplet<double>;
    std::vector<std::vector<Triplet>> triplets(blocks.blocks.size());
    threads.for_chunks(blocks.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<Eigen::Vector4d> image(blocks.size(), Eigen::Vector4d::Zero());
        std::vector<char> reached(blocks.size(), 0), met(blocks.blocks.size(), 0);
        std::vector<Eigen::Matrix4d> product(blocks.blocks.size());
        std::vector<std::uint32_t> reach, meets;
        for (std::size_t b = begin; b < end; ++b) {
            const Eigen::MatrixXd& Z = functions[b];
            if (Z.cols() == 0) continue;

            // image = S Z_b
            reach.clear();
            for (std::size_t k = 0; k < blocks.blocks[b].extended.size(); ++k) {
                const std::uint32_t i = blocks.blocks[b].extended[k];
                Eigen::Vector4d z = Eigen::Vector4d::Zero();
                z.head(Z.cols()) = Z.row(static_cast<Eigen::Index>(k));
                for (std::size_t e = S.row[i]; e < S.row[i + 1]; ++e) {
                    const std::uint32_t j = S.column[e];
                    if (!reached[j]) reached[j] = 1, reach.push_back(j);
                    image[j] += S.value[e] * z;
                }
            }
            std::sort(reach.begin(), reach.end());

            // Z^T image
            meets.clear();
            for (const std::uint32_t j : reach) {
                for (std::size_t p = place_offset[j]; p < place_offset[j + 1]; ++p) {
                    const auto [other, k] = place[p];
                    if (other > b) continue;
                    if (!met[other]) met[other] = 1, meets.push_back(other), product[other].setZero();
                    const Eigen::MatrixXd& Y = functions[other];
                    product[other].topRows(Y.cols()) += Y.row(k).transpose() * image[j].transpose();
                }
                image[j].setZero();
                reached[j] = 0;
            }
            for (const std::uint32_t other : meets) {
                met[other] = 0;
                for (Eigen::Index r = 0; r < functions[other].cols(); ++r)
                    for (Eigen::Index c = 0; c < Z.cols(); ++c)
                        if (first_function[other] + r <= first_function[b] + c)
                            triplets[b].emplace_back(static_cast<int>(first_function[b] + c),
                                                     static_cast<int>(first_function[other] + r), product[other](r, c));
            }
        }
    });
    std::vector<Triplet> all;
    for (const auto& t : triplets) all.insert(all.end(), t.begin(), t.end());
    Eigen::SparseMatrix<double> A(coarse_size(), coarse_size());  // lower triangle
    A.setFromTriplets(all.begin(), all.end());

    // scaled to a unit diagonal, shifted, factored
    coarse_scale = A.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
    A = coarse_scale.asDiagonal() * A * coarse_scale.asDiagonal();
    for (double shift = coarse_shift;; shift *= 10) {
        for (Eigen::Index k = 0; k < coarse_size(); ++k) A.coeffRef(k, k) = 1 + shift;
        if (coarse_size() <= dense_coarse_limit) {
            coarse_dense.compute(Eigen::MatrixXd(A));
            if (coarse_dense.info() == Eigen::Success) return;
        } else {
            coarse_sparse.compute(A);
            if (coarse_sparse.info() == Eigen::Success) return;
        }
    }
}

void ConsistencyPreconditioner::Parts::solve_coarse(std::span<const Vec3> r, const Threads& threads) {
    threads.for_each(blocks.blocks.size(), 16, [&](std::size_t b) {
        const Eigen::MatrixXd& Z = functions[b];
        auto moment = coarse.middleRows(first_function[b], Z.cols());
        moment.setZero();
        if (Z.cols() == 0) return;
        for (std::size_t k = 0; k < blocks.blocks[b].extended.size(); ++k) {
            const Vec3& ri = r[blocks.blocks[b].extended[k]];
            moment += Z.row(static_cast<Eigen::Index>(k)).transpose() * Eigen::RowVector3d(ri.x, ri.y, ri.z);
        }
    });
    coarse = coarse_scale.asDiagonal() * coarse;
    if (coarse_size() <= dense_coarse_limit) coarse_dense.solveInPlace(coarse);
    else coarse = Eigen::MatrixXd(coarse_sparse.solve(coarse));
    coarse = coarse_scale.asDiagonal() * coarse;
}

ConsistencyPreconditioner::ConsistencyPreconditioner(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks,
                                                     double overlap, const Threads& threads)
    : parts_(new Parts(blocks)) {
    parts_->local.resize(blocks.blocks.size());
    parts_->answer.resize(blocks.blocks.size());
    threads.for_chunks(blocks.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> number(blocks.size(), ConsistencyBlocks::none);
        for (std::size_t b = begin; b < end; ++b) {
            parts_->local[b].factor(S, blocks.blocks[b].extended, number);
            parts_->answer[b].resize(static_cast<Eigen::Index>(blocks.blocks[b].extended.size()), 3);
        }
    });
    parts_->find_places();
    parts_->build_coarse(S, overlap, threads);
    parts_->coarse.resize(parts_->coarse_size(), 3);
}

ConsistencyPreconditioner::~ConsistencyPreconditioner() = default;

void ConsistencyPreconditioner::apply(std::span<const Vec3> r, std::span<Vec3> z, const Threads& threads) {
    Parts& parts = *parts_;
    threads.for_each(parts.local.size(), 4, [&](std::size_t b) {
        const std::vector<std::uint32_t>& nodes = parts.blocks.blocks[b].extended;
        const std::vector<double>& scale = parts.local[b].scale;
        Eigen::MatrixXf& x = parts.answer[b];
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const Vec3 scaled = scale[k] * r[nodes[k]];
            x.row(static_cast<Eigen::Index>(k)) = Eigen::RowVector3d(scaled.x, scaled.y, scaled.z).cast<float>();
        }
        parts.local[b].solve(x);
    });
    if (parts.coarse_size() > 0) parts.solve_coarse(r, threads);
    threads.for_each(z.size(), 512, [&](std::size_t i) {
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        for (std::size_t p = parts.place_offset[i]; p < parts.place_offset[i + 1]; ++p) {
            const auto [b, k] = parts.place[p];
            sum += parts.local[b].scale[k] * parts.answer[b].row(k).cast<double>();
            const Eigen::MatrixXd& Z = parts.functions[b];
            if (Z.cols() > 0) sum += Z.row(k) * parts.coarse.middleRows(parts.first_function[b], Z.cols());
        }
        z[i] = {sum[0], sum[1], sum[2]};
    });
}

}  // namespace phyxel
