#include "approximation/consistency_fit.h"

#include <cmath>
#include <utility>

#include "approximation/kernel.h"

namespace phyxel {

namespace {

/// Directions in which the nodes spread by less than this part of their whole (weighted) variance do not count: the
/// nodes are coplanar, in line, or one lump. Well above rounding, well below the thinnest stencil that is of use.
constexpr double negligible_variance = 1e-8;

}  // namespace

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

void apply_projector(const WeightedStencil& stencil, const LinearFit& fit, std::span<Vec3> lambda) {
    // the second pass takes away what rounding left of a large linear part
    for (int pass = 0; pass < 2; ++pass) {
        std::array<Vec3, 4> moment{};
        for (std::size_t i = 0; i < stencil.size(); ++i)
            for (std::size_t k = 0; k < 4; ++k)
                moment[k] += stencil.weight[i] * fit(k, stencil.position[i]) * lambda[i];
        for (std::size_t i = 0; i < stencil.size(); ++i)
            for (std::size_t k = 0; k < 4; ++k) lambda[i] -= fit(k, stencil.position[i]) * moment[k];
    }
    for (std::size_t i = 0; i < stencil.size(); ++i) lambda[i] *= stencil.weight[i];
}

}  // namespace phyxel
