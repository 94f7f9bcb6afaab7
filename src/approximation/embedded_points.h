#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "approximation/stencils.h"

namespace phyxel {

/// Points that follow the nodes without acting on the material: surface vertices, loaded or held patches, probes.
/// x = sum_i phi_i x_i (Brunet et al. 2019, section 3.4); a force f at the point is phi_i f at the nodes (eq. 17).
struct EmbeddedPoints {
    std::vector<std::uint32_t> offset{0};  ///< [points + 1] into the rest
    std::vector<std::uint32_t> node;       ///< [pairs]
    std::vector<double> phi;               ///< [pairs]
    std::vector<Vec3> gradient;            ///< [pairs] [1/m] in rest space; empty unless asked for

    std::size_t size() const { return offset.size() - 1; }

    Vec3 position(std::size_t p, std::span<const Vec3> nodes) const {
        Vec3 x{};
        for (std::uint32_t k = offset[p]; k < offset[p + 1]; ++k) x += phi[k] * nodes[node[k]];
        return x;
    }
    /// sum |phi_i| of a point: phi phi^T <= sum |phi| diag(|phi|).
    double absolute_sum(std::size_t p) const {
        double sum = 0;
        for (std::uint32_t k = offset[p]; k < offset[p + 1]; ++k) sum += std::abs(phi[k]);
        return sum;
    }
    /// Deformation gradient at the point; needs `gradient`.
    Mat3 deformation_gradient(std::size_t p, std::span<const Vec3> nodes) const {
        Mat3 F;
        const Vec3 origin = nodes[node[offset[p]]];
        for (std::uint32_t k = offset[p]; k < offset[p + 1]; ++k) F += outer(nodes[node[k]] - origin, gradient[k]);
        return F;
    }
};

enum class Gradients { no, yes };

/// Shape functions at `positions` (lattice frame), each in the cell given for it.
EmbeddedPoints embed(const Sampling& sampling, const ApproximationSettings& settings, std::span<const Vec3> positions,
                     std::span<const std::uint32_t> cells, Gradients gradients, const Threads& threads);

}  // namespace phyxel
