#include "solver/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "forces/stiffness_diagonal.h"
#include "solver/nodal_vectors.h"

namespace phyxel {
namespace {

constexpr std::size_t dense_nodes = 120;  ///< below which a Cholesky factor is cheaper than another level
constexpr int power_iterations = 20;

/// Share of the spectrum, from the top down, that a smoothing step damps as evenly as one can.
constexpr double smoothed_share = 0.75;

/// To eight binary digits: steps whose lengths differ by rounding share their operators.
double rounded(double weight) {
    int exponent = 0;
    const double mantissa = std::frexp(weight, &exponent);
    return std::ldexp(std::round(mantissa * 256), exponent - 8);
}

Mat3 masked(const Mat3& A, const Vec3& free) {
    Mat3 result;
    for (std::size_t r = 0; r < 3; ++r) result.rows[r] = free[r] * times(free, A.rows[r]);
    return result;
}

Mat3f diagonal_float(const Vec3& d) { return Mat3f::diagonal(vector_cast<float>(d)); }

/// Places of the nodes from the lowest corner of the body, in spacings.
std::vector<Vec3> places_of_nodes(const Model& m) {
    Vec3 low = m.sampling.nodes.front();
    for (const Vec3& p : m.sampling.nodes)
        for (std::size_t d = 0; d < 3; ++d) low[d] = std::min(low[d], p[d]);
    std::vector<Vec3> places;
    for (const Vec3& p : m.sampling.nodes) places.push_back((p - low) / m.sampling.spacing);
    return places;
}

/// Galerkin mass, as diagonal blocks in the pattern of a block matrix.
std::vector<Vec3> galerkin_mass(const BlockMatrix& pattern, BlockRows rows) {
    const BlockMatrix mass = rows.compressed();
    std::vector<Vec3> values(pattern.column.size());
    for (std::size_t i = 0; i < mass.rows(); ++i) {
        std::size_t at = pattern.offset[i];
        for (std::size_t k = mass.offset[i]; k < mass.offset[i + 1]; ++k) {
            while (at < pattern.offset[i + 1] && pattern.column[at] < mass.column[k]) ++at;
            if (at == pattern.offset[i + 1] || pattern.column[at] != mass.column[k]) continue;
            values[at] = {mass.value[k](0, 0), mass.value[k](1, 1), mass.value[k](2, 2)};
        }
    }
    return values;
}

}  // namespace

struct RestMultigrid::Level {
    std::size_t nodes = 0;
    Coarsening coarsening;   ///< to the next level
    BlockMatrix stiffness;   ///< K; empty on level 0
    std::vector<Vec3> mass;  ///< [blocks of K]; on level 0 [nodes]
    BlockMatrix support;     ///< stiffness of the nodes' own; no rows: none
    BlockMatrix sum;         ///< s K + c M + support; empty on level 0
    PatchRows patches;
    BlockJacobi jacobi;
    double largest = 1;             ///< eigenvalue of the smoothed operator
    std::vector<Vec3f> r, x, d, t;  ///< [nodes] residual, result, change, product
};

struct RestMultigrid::CoarseFactor {
    Eigen::LLT<Eigen::MatrixXd> llt;
    Eigen::VectorXd b;
};

RestMultigrid::~RestMultigrid() = default;
RestMultigrid::RestMultigrid(RestMultigrid&&) noexcept = default;

RestMultigrid::RestMultigrid(const Model& model, const Constraints& constraints, const Threads& threads)
    : model_(model), free_(constraints.free_components(model.rest.size())) {
    if (RestStiffness::applies_to(model)) fast_ = std::make_unique<RestStiffness>(model, threads);
    diagonal_ = stiffness_diagonal(model, threads);
    std::vector<Vec3> places = places_of_nodes(model);
    Level fine;
    fine.nodes = model.rest.size();
    for (std::size_t i = 0; i < fine.nodes; ++i) fine.mass.push_back(model.mass[i] * free_[i]);
    fine.patches = PatchRows(constraints, free_);
    levels_.push_back(std::move(fine));

    std::vector<std::uint32_t> parts = separate_parts(model.sampling);

    // Coarser levels, until few nodes are left or no more go.
    while (levels_.size() == 1 || levels_.back().nodes > dense_nodes) {
        Level& last = levels_.back();
        last.coarsening = coarsen(places, parts);
        const Coarsening& c = last.coarsening;
        if (levels_.size() > 1 && c.places.size() == last.nodes) break;
        Level next;
        next.nodes = c.places.size();
        BlockRows stiffness =
            levels_.size() == 1 ? galerkin_stiffness(model, c, free_, threads) : galerkin_product(last.stiffness, c);
        BlockMatrix fine_mass;  // diagonal on level 0
        if (levels_.size() == 1) {
            for (std::uint32_t i = 0; i < last.nodes; ++i) {
                fine_mass.column.push_back(i);
                fine_mass.value.push_back(diagonal_float(last.mass[i]));
                fine_mass.offset.push_back(i + 1);
            }
        } else {
            fine_mass = last.stiffness;
            for (std::size_t k = 0; k < fine_mass.value.size(); ++k) fine_mass.value[k] = diagonal_float(last.mass[k]);
        }
        next.stiffness = stiffness.compressed();
        next.mass = galerkin_mass(next.stiffness, galerkin_product(fine_mass, c));
        next.patches = last.patches.coarsened(c);
        parts = c.parts;
        places.clear();
        for (const auto& place : c.places) places.push_back({double(place[0]), double(place[1]), double(place[2])});
        Vec3 low = places.front();
        for (const Vec3& p : places)
            for (std::size_t d = 0; d < 3; ++d) low[d] = std::min(low[d], p[d]);
        for (Vec3& p : places) p -= low;
        levels_.push_back(std::move(next));
    }
    for (Level& level : levels_)
        for (auto* v : {&level.r, &level.x, &level.d, &level.t}) v->resize(level.nodes);
    factor_ = std::make_unique<CoarseFactor>();
}

void RestMultigrid::set_weights(double stiffness, double inertia, const Threads& threads) {
    stiffness = rounded(stiffness), inertia = rounded(inertia);
    if (stiffness == stiffness_ && inertia == inertia_) return;
    stiffness_ = stiffness, inertia_ = inertia;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].support = {};
        assemble(l);
        // Supports stand in the diagonal too and do not raise it.
        if (l + 1 < levels_.size()) levels_[l].largest = 1.05 * largest_eigenvalue(l, threads);
    }
}

void RestMultigrid::set_supports(std::vector<Mat3> blocks) {
    if (blocks.empty() && levels_.front().support.rows() == 0) return;
    BlockMatrix support;
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        if (!(blocks[i] == Mat3{})) {
            support.column.push_back(i);
            support.value.push_back(to_float(masked(blocks[i], free_[i])));
        }
        support.offset.push_back(support.column.size());
    }
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].support = std::move(support);
        assemble(l);
        support = {};
        if (l + 1 < levels_.size() && levels_[l].support.rows() > 0)
            support = galerkin_product(levels_[l].support, levels_[l].coarsening).compressed();
    }
}

void RestMultigrid::assemble(std::size_t l) {
    Level& level = levels_[l];
    std::vector<Mat3> diagonal(level.nodes);
    if (l == 0) {
        for (std::size_t i = 0; i < level.nodes; ++i)
            diagonal[i] = stiffness_ * masked(diagonal_[i], free_[i]) + Mat3::diagonal(inertia_ * level.mass[i]);
        for (std::size_t i = 0; i < level.support.rows(); ++i)
            for (std::size_t k = level.support.offset[i]; k < level.support.offset[i + 1]; ++k)
                diagonal[i] += to_double(level.support.value[k]);
    } else {
        BlockMatrix& sum = level.sum;
        sum = level.stiffness;
        for (std::size_t k = 0; k < sum.value.size(); ++k)
            sum.value[k] =
                static_cast<float>(stiffness_) * level.stiffness.value[k] + diagonal_float(inertia_ * level.mass[k]);
        for (std::size_t i = 0; i < level.nodes; ++i) {
            // Supports couple no nodes that the body's stiffness does not.
            const std::size_t begin = sum.offset[i], end = sum.offset[i + 1];
            const auto place = [&](std::uint32_t column) {
                const auto first = sum.column.begin();
                return static_cast<std::size_t>(std::lower_bound(first + static_cast<std::ptrdiff_t>(begin),
                                                                 first + static_cast<std::ptrdiff_t>(end), column) -
                                                first);
            };
            if (level.support.rows() > 0)
                for (std::size_t k = level.support.offset[i]; k < level.support.offset[i + 1]; ++k) {
                    const std::size_t at = place(level.support.column[k]);
                    if (at < end && sum.column[at] == level.support.column[k]) sum.value[at] += level.support.value[k];
                }
            const std::size_t at = place(static_cast<std::uint32_t>(i));
            if (at < end && sum.column[at] == i) diagonal[i] = to_double(sum.value[at]);
        }
    }
    if (l + 1 < levels_.size()) level.jacobi = BlockJacobi(diagonal, level.patches);
    else factorize();
}

/// The coarsest level: dense, shifted so that fields which no node sees do not stop the factor.
void RestMultigrid::factorize() {
    const Level& level = levels_.back();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * Eigen::Index(level.nodes), 3 * Eigen::Index(level.nodes));
    const auto add_blocks = [&A](const BlockMatrix& blocks) {
        for (std::size_t i = 0; i < blocks.rows(); ++i)
            for (std::size_t k = blocks.offset[i]; k < blocks.offset[i + 1]; ++k)
                for (std::size_t a = 0; a < 3; ++a)
                    for (std::size_t b = 0; b < 3; ++b)
                        A(Eigen::Index(3 * i + a), Eigen::Index(3 * blocks.column[k] + b)) +=
                            static_cast<double>(blocks.value[k](a, b));
    };
    add_blocks(level.sum);
    BlockRows penalties(level.nodes);
    level.patches.add_to(penalties);
    add_blocks(penalties.compressed());
    A = (0.5 * (A + A.transpose())).eval();
    A.diagonal().array() += std::max(1e-7 * A.diagonal().maxCoeff(), 1e-300);
    factor_->llt.compute(A);
    factor_->b.resize(A.rows());
}

double RestMultigrid::largest_eigenvalue(std::size_t l, const Threads& threads) {
    Level& level = levels_[l];
    for (std::size_t i = 0; i < level.nodes; ++i) {
        const auto wave = [&](double k) { return static_cast<float>(std::sin(k * static_cast<double>(i + 1))); };
        level.d[i] = {wave(1.7), wave(2.9), wave(4.3)};
        if (l == 0) level.d[i] = times(vector_cast<float>(free_[i]), level.d[i]);
    }
    double lambda = 0;
    for (int k = 0; k < power_iterations; ++k) {
        const double size = std::sqrt(inner(level.d, level.d, threads));
        if (!(size > 0)) return 1;
        threads.for_each(level.nodes, node_chunk, [&](std::size_t i) { level.d[i] /= static_cast<float>(size); });
        multiply(l, level.d, level.t, threads);
        level.jacobi.apply(level.t, level.d, threads);
        lambda = std::sqrt(inner(level.d, level.d, threads));
    }
    return lambda;
}

void RestMultigrid::multiply(std::size_t l, const std::vector<Vec3f>& d, std::vector<Vec3f>& out,
                             const Threads& threads) {
    Level& level = levels_[l];
    if (l == 0) {
        if (fast_) {
            fast_->apply(model_, d, threads, out);
        } else {
            wide_d_.resize(d.size());
            wide_out_.resize(d.size());
            threads.for_each(d.size(), node_chunk, [&](std::size_t i) { wide_d_[i] = vector_cast<double>(d[i]); });
            stiffness_action(model_, model_.rest, wide_d_, work_, threads, wide_out_);
            threads.for_each(d.size(), node_chunk, [&](std::size_t i) { out[i] = vector_cast<float>(wide_out_[i]); });
        }
        const auto s = static_cast<float>(stiffness_);
        threads.for_each(level.nodes, node_chunk, [&](std::size_t i) {
            const Vec3f free = vector_cast<float>(free_[i]), mass = vector_cast<float>(inertia_ * level.mass[i]);
            out[i] = times(free, s * out[i]) + times(mass, d[i]);
            if (level.support.rows() > 0)
                for (std::size_t k = level.support.offset[i]; k < level.support.offset[i + 1]; ++k)
                    out[i] += level.support.value[k] * d[i];
        });
    } else {
        level.sum.multiply(d, out, threads);
    }
    level.patches.add_action(d, out);
}

/// A step of damped block Jacobi: adds d = omega D^-1 r to x.
void RestMultigrid::smooth(std::size_t l, bool from_zero, const Threads& threads) {
    Level& level = levels_[l];
    const auto omega = static_cast<float>(2 / ((2 - smoothed_share) * level.largest));
    level.jacobi.apply(level.r, level.d, threads);
    threads.for_each(level.nodes, node_chunk, [&](std::size_t i) {
        level.d[i] *= omega;
        level.x[i] = from_zero ? level.d[i] : level.x[i] + level.d[i];
    });
}

void RestMultigrid::cycle(std::size_t l, const Threads& threads) {
    Level& level = levels_[l];
    if (l + 1 == levels_.size()) {
        for (std::size_t i = 0; i < level.nodes; ++i)
            for (std::size_t d = 0; d < 3; ++d)
                factor_->b[static_cast<Eigen::Index>(3 * i + d)] = static_cast<double>(level.r[i][d]);
        factor_->llt.solveInPlace(factor_->b);
        for (std::size_t i = 0; i < level.nodes; ++i)
            for (std::size_t d = 0; d < 3; ++d)
                level.x[i][d] = static_cast<float>(factor_->b[static_cast<Eigen::Index>(3 * i + d)]);
        return;
    }
    // Smooth, solve what is left on the coarser level, smooth again.
    smooth(l, true, threads);
    multiply(l, level.d, level.t, threads);
    add_scaled(level.r, -1.0f, level.t, threads);
    Level& next = levels_[l + 1];
    const auto gather = [&](const SparseRows& rows, const std::vector<Vec3f>& from, std::vector<Vec3f>& to) {
        threads.for_each(to.size(), 256, [&](std::size_t i) {
            Vec3f sum{};
            for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k)
                sum += static_cast<float>(rows.value[k]) * from[rows.column[k]];
            to[i] = sum;
        });
    };
    gather(level.coarsening.restriction, level.r, next.r);
    cycle(l + 1, threads);
    gather(level.coarsening.prolongation, next.x, level.d);
    if (l == 0)
        threads.for_each(level.nodes, node_chunk,
                         [&](std::size_t i) { level.d[i] = times(vector_cast<float>(free_[i]), level.d[i]); });
    multiply(l, level.d, level.t, threads);
    threads.for_each(level.nodes, node_chunk, [&](std::size_t i) {
        level.r[i] -= level.t[i];
        level.x[i] += level.d[i];
    });
    smooth(l, false, threads);
}

std::vector<Vec3f>& RestMultigrid::residual() { return levels_.front().r; }
const std::vector<Vec3f>& RestMultigrid::result() const { return levels_.front().x; }

}  // namespace phyxel
