#include "approximation/consistency_fit.h"

#include <cmath>
#include <utility>

#include "approximation/kernel.h"

namespace phyxel {

namespace {

/// Directions in which the nodes spread by less than this part of their whole (weighted) variance do not count: the
/// nodes are coplanar, in line, or one lump. Well above rounding, well below the thinnest stencil that is of use.
constexpr double negligible_variance = 1e-8;

/// Four functions a node, a lane each; then four moments of three columns, a lane a column.
[[gnu::always_inline]] inline void evaluate_kernel(const LinearFit& fit, std::span<const Vec3> position,
                                                   std::span<Double4> linear) {
    const Lanes value = {fit.value[0], fit.value[1], fit.value[2], fit.value[3]};
    const Lanes x = {fit.slope[0].x, fit.slope[1].x, fit.slope[2].x, fit.slope[3].x};
    const Lanes y = {fit.slope[0].y, fit.slope[1].y, fit.slope[2].y, fit.slope[3].y};
    const Lanes z = {fit.slope[0].z, fit.slope[1].z, fit.slope[2].z, fit.slope[3].z};
    for (std::size_t i = 0; i < position.size(); ++i)
        lanes(linear[i]) = value + (x * position[i].x + y * position[i].y + z * position[i].z);
}

[[gnu::always_inline]] inline void project_kernel(std::span<const double> weight, std::span<const Double4> linear,
                                                  std::span<Vec3> lambda) {
    // the second pass takes away what rounding left of a large linear part
    for (int pass = 0; pass < 2; ++pass) {
        Lanes moment[4] = {};
        for (std::size_t i = 0; i < lambda.size(); ++i) {
            const Lanes l = Lanes{lambda[i].x, lambda[i].y, lambda[i].z, 0} * weight[i];
            for (std::size_t k = 0; k < 4; ++k) moment[k] += l * linear[i].lane[k];
        }
        for (std::size_t i = 0; i < lambda.size(); ++i) {
            Lanes fitted = moment[0] * linear[i].lane[0];
            for (std::size_t k = 1; k < 4; ++k) fitted += moment[k] * linear[i].lane[k];
            lambda[i] -= Vec3{fitted[0], fitted[1], fitted[2]};
        }
    }
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] *= weight[i];
}

PHYXEL_AVX2 void evaluate_avx2(const LinearFit& fit, std::span<const Vec3> position, std::span<Double4> linear) {
    evaluate_kernel(fit, position, linear);
}
PHYXEL_AVX2 void project_avx2(std::span<const double> weight, std::span<const Double4> linear, std::span<Vec3> lambda) {
    project_kernel(weight, linear, lambda);
}

}  // namespace

void WeightedStencil::evaluate(const LinearFit& fit) {
    linear.resize(size());
    if (has_avx2()) evaluate_avx2(fit, position, linear);
    else evaluate_kernel(fit, position, linear);
}

void WeightedStencil::load(const ConsistencyInput& input, std::size_t point) {
    const std::size_t begin = input.offset[point], end = input.offset[point + 1];
    node = input.node.subspan(begin, end - begin);
    position.resize(node.size());
    weight.resize(node.size());
    const double inverse_support = 1 / input.support[point];
    for (std::size_t i = 0; i < node.size(); ++i) {
        position[i] = (input.nodes[node[i]] - input.points[point]) * inverse_support;
        weight[i] = phyxel::weight(input.kernel, norm(position[i]));
    }
}

LinearFit fit_linear(std::span<const Vec3> position, std::span<const double> weight) {
    LinearFit fit;
    double total = 0;
    Vec3 mean;
    for (std::size_t i = 0; i < position.size(); ++i) {
        total += weight[i];
        mean += weight[i] * position[i];
    }
    if (!(total > 0)) return fit;
    mean /= total;
    fit.value[0] = 1 / std::sqrt(total);

    Mat3 variance;
    for (std::size_t i = 0; i < position.size(); ++i) {
        const Vec3 e = position[i] - mean;
        variance += outer(weight[i] * e, e);
    }

    // Gram-Schmidt on the three axes, the one with most variance left first
    Vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto left = [&](std::size_t a) { return dot(axis[a], variance * axis[a]); };
        std::size_t best = k;
        for (std::size_t a = k + 1; a < 3; ++a)
            if (left(a) > left(best)) best = a;
        std::swap(axis[k], axis[best]);
        if (!(left(k) > negligible_variance * trace(variance))) break;
        const Vec3 slope = axis[k] / std::sqrt(left(k));
        for (std::size_t a = k + 1; a < 3; ++a) axis[a] -= dot(axis[a], variance * slope) * slope;
        fit.slope[k + 1] = slope;
        fit.value[k + 1] = -dot(slope, mean);
    }
    return fit;
}

void apply_projector(WeightedStencil& stencil, const LinearFit& fit, std::span<Vec3> lambda) {
    stencil.evaluate(fit);
    if (has_avx2()) project_avx2(stencil.weight, stencil.linear, lambda);
    else project_kernel(stencil.weight, stencil.linear, lambda);
}

}  // namespace phyxel
