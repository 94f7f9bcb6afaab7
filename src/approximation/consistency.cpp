#include "approximation/consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "approximation/consistency_blocks.h"
#include "approximation/consistency_fit.h"
#include "approximation/consistency_matrix.h"
#include "approximation/consistency_preconditioner.h"

namespace phyxel {

namespace {

/// Residual to reach, in units of the largest sum_q V_q |g_qi|: well below the 1e-10 asked of the force patch test, and
/// some four times what rounding leaves of it at 75,000 nodes.
constexpr double tolerance = 4e-12;
/// Nodes a block. Twice as many in larger bodies take a third more iterations and keep the coarse system small.
constexpr std::size_t block_size = 64, large_body = 8000;
/// Conjugate gradients end after so many iterations, or when the residual has not halved in `patience` of them.
constexpr int most_iterations = 500, patience = 100;
/// Each restart begins from the residual computed anew from the gradients.
constexpr int most_restarts = 8;
/// Single precision carries one solution so far, relative to the residual it began with; then the next one begins.
constexpr double reduction = 1e-6;

constexpr std::size_t points_a_chunk = 256, nodes_a_chunk = 1024;

/// Largest |r_i|, and NaN-safe: anything not finite counts as infinite.
double max_norm(std::span<const Vec3> r) {
    double result = 0;
    for (const Vec3& v : r) result = std::max(result, is_finite(v) ? norm(v) : std::numeric_limits<double>::infinity());
    return result;
}

Vec3 componentwise(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

Vec3 dot_columns(std::span<const Vec3> a, std::span<const Vec3> b, const Threads& threads) {
    return threads.sum<Vec3>(a.size(), nodes_a_chunk, [&](std::size_t i) { return componentwise(a[i], b[i]); });
}

/// a / b per column; a column that is done (b = 0) stays.
Vec3 ratio(const Vec3& a, const Vec3& b) {
    return {b.x > 0 ? a.x / b.x : 0, b.y > 0 ? a.y / b.y : 0, b.z > 0 ? a.z / b.z : 0};
}

/// Largest sum_q V_q |g_qi| of a node.
double force_scale(const ConsistencyInput& input, std::span<const Vec3> gradient) {
    std::vector<double> sum(input.nodes.size(), 0.0);
    for (std::size_t q = 0; q < input.points.size(); ++q)
        for (std::size_t pair = input.offset[q]; pair < input.offset[q + 1]; ++pair)
            sum[input.node[pair]] += input.volumes[q] * norm(gradient[pair]);
    return sum.empty() ? 0 : *std::max_element(sum.begin(), sum.end());
}

/// Takes the part out of a vector that S cannot see: a linear function on each connected part.
class NullSpace {
public:
    explicit NullSpace(const ConsistencyBlocks& blocks) : blocks_(blocks) {
        const std::vector<double> ones(blocks.size(), 1.0);
        for (std::size_t c = 0; c + 1 < blocks.component_begin.size(); ++c) {
            const std::size_t begin = blocks.component_begin[c], count = blocks.component_begin[c + 1] - begin;
            fits_.push_back(fit_linear(std::span(blocks.position).subspan(begin, count), std::span(ones).first(count)));
        }
    }

    void project_out(std::span<Vec3> v) const {
        for (std::size_t c = 0; c < fits_.size(); ++c) {
            const std::size_t begin = blocks_.component_begin[c], end = blocks_.component_begin[c + 1];
            std::array<Vec3, 4> moment{};
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t k = 0; k < 4; ++k) moment[k] += fits_[c](k, blocks_.position[i]) * v[i];
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t k = 0; k < 4; ++k) v[i] -= fits_[c](k, blocks_.position[i]) * moment[k];
        }
    }

private:
    const ConsistencyBlocks& blocks_;
    std::vector<LinearFit> fits_;  // [components]
};

/// Preconditioned conjugate gradients for S x = r, the three columns side by side, each with its own coefficients.
/// Returns x; `r` becomes the residual by recurrence.
std::vector<Vec3> solve(const ConsistencyMatrix& S, const ConsistencyBlocks& blocks, const NullSpace& null_space,
                        ConsistencyPreconditioner& M, std::vector<Vec3>& r, double target, int& iterations,
                        const Threads& threads) {
    const std::size_t n = r.size();
    std::vector<Vec3> x(n), z(n), p(n), Sp(n);
    Vec3 rz;
    double best = max_norm(r);
    for (int since_best = 0; iterations < most_iterations && since_best < patience && max_norm(r) > target;
         ++iterations) {
        null_space.project_out(r);
        M.apply(r, z, threads);
        const Vec3 rz_before = rz;
        rz = dot_columns(r, z, threads);
        const Vec3 beta = ratio(rz, rz_before);
        for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + componentwise(beta, p[i]);
        S.multiply(blocks, p, Sp, threads);
        const Vec3 alpha = ratio(rz, dot_columns(p, Sp, threads));
        for (std::size_t i = 0; i < n; ++i) {
            x[i] += componentwise(alpha, p[i]);
            r[i] -= componentwise(alpha, Sp[i]);
        }
        ++since_best;
        if (const double now = max_norm(r); now < 0.5 * best) best = now, since_best = 0;
    }
    return x;
}

/// gradient += S_q lambda, residual -= V_q S_q lambda.
void apply_correction(const ConsistencyInput& input, std::span<const LinearFit> fits, const ConsistencyBlocks& blocks,
                      std::span<const Vec3> lambda, std::span<Vec3> gradient, std::span<Vec3> residual,
                      const Threads& threads) {
    // A batch of points at a time: the changes of all of them would take as much memory as the gradients.
    constexpr std::size_t batch = 16 * points_a_chunk;
    std::vector<Vec3> change;
    for (std::size_t first = 0; first < input.points.size(); first += batch) {
        const std::size_t last = std::min(first + batch, input.points.size()), origin = input.offset[first];
        change.resize(input.offset[last] - origin);
        threads.for_chunks(last - first, points_a_chunk, [&](std::size_t begin, std::size_t end) {
            WeightedStencil stencil;
            for (std::size_t q = first + begin; q < first + end; ++q) {
                stencil.load(input, q);
                const auto d = std::span(change).subspan(input.offset[q] - origin, stencil.size());
                const auto g = gradient.subspan(input.offset[q], stencil.size());
                for (std::size_t i = 0; i < d.size(); ++i) d[i] = lambda[blocks.number[stencil.node[i]]];
                apply_projector(stencil, fits[q], d);
                for (std::size_t i = 0; i < d.size(); ++i) {
                    g[i] += d[i];
                    d[i] *= input.volumes[q];
                }
            }
        });
        for (std::size_t pair = origin; pair < input.offset[last]; ++pair)
            residual[input.node[pair]] -= change[pair - origin];
    }
}

}  // namespace

ConsistencyReport make_consistent(const ConsistencyInput& input, std::span<Vec3> gradient, const Threads& threads) {
    ConsistencyReport report;
    std::vector<Vec3> residual(input.residual.begin(), input.residual.end());
    if (max_norm(residual) == 0) return report;
    const double scale = std::max(force_scale(input, gradient), max_norm(residual));
    const auto relative = [&] { return max_norm(residual) / scale; };
    report.residual_before = report.residual_after = relative();
    if (report.residual_before <= tolerance) return report;

    // the system
    std::vector<LinearFit> fits(input.points.size());
    threads.for_chunks(input.points.size(), points_a_chunk, [&](std::size_t begin, std::size_t end) {
        WeightedStencil stencil;
        for (std::size_t q = begin; q < end; ++q) {
            stencil.load(input, q);
            fits[q] = fit_linear(stencil.position, stencil.weight);
        }
    });
    const ConsistencyBlocks blocks =
        cut_into_blocks(input, input.nodes.size() <= large_body ? block_size : 2 * block_size);
    report.zone_nodes = blocks.size();
    // in units that single precision holds, whatever the body's size
    const double unit = *std::max_element(input.volumes.begin(), input.volumes.end());
    std::vector<double> volume_in_units;
    for (const double V : input.volumes) volume_in_units.push_back(V / unit);
    ConsistencyInput in_units = input;
    in_units.volumes = volume_in_units;
    const ConsistencyMatrix S = assemble(in_units, fits, blocks, threads);
    ConsistencyPreconditioner M(S, blocks, threads);
    const NullSpace null_space(blocks);

    // its solution
    for (int restart = 0; restart < most_restarts && report.residual_after > tolerance; ++restart) {
        const double largest = max_norm(residual);
        std::vector<Vec3> r(blocks.size());
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = residual[blocks.node[i]] / largest;
        const double target = std::max(0.25 * tolerance * scale / largest, reduction);
        std::vector<Vec3> lambda = solve(S, blocks, null_space, M, r, target, report.iterations, threads);
        for (Vec3& l : lambda) l *= largest / unit;
        apply_correction(input, fits, blocks, lambda, gradient, residual, threads);
        const double before = report.residual_after;
        report.residual_after = relative();
        if (!(report.residual_after < 0.5 * before)) break;
    }
    report.converged = report.residual_after <= tolerance;
    return report;
}

}  // namespace phyxel
