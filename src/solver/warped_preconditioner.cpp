#include "solver/warped_preconditioner.h"

#include <algorithm>
#include <cmath>

#include "base/polar.h"
#include "solver/nodal_vectors.h"

namespace phyxel {
namespace {

constexpr double flat = 0.1;  ///< of det F, below which a node's frame is left as it is

}  // namespace

WarpedPreconditioner::WarpedPreconditioner(const Model& model, const Constraints& constraints, FastForces* fast,
                                           const Threads& threads)
    : model_(model), multigrid_(model, constraints, fast, threads) {
    const Sampling& s = model.sampling;
    std::vector<std::vector<std::uint32_t>> points(model.rest.size());
    for (std::uint32_t q = 0; q < s.point_cell.size(); ++q)
        for (std::uint32_t node : s.cell_nodes[s.point_cell[q]])
            if (node != no_index) points[node].push_back(q);
    offset_.push_back(0);
    for (const auto& list : points) {
        point_.insert(point_.end(), list.begin(), list.end());
        offset_.push_back(static_cast<std::uint32_t>(point_.size()));
    }
    rotation_.assign(model.rest.size(), Mat3::identity());
}

void WarpedPreconditioner::set_weights(double stiffness, double inertia, const Threads& threads) {
    multigrid_.set_weights(stiffness, inertia, threads);
}

void WarpedPreconditioner::set_supports(std::vector<Mat3> blocks, const Threads& threads) {
    threads.for_each(blocks.size(), 64, [&](std::size_t i) {
        if (!(blocks[i] == Mat3{})) blocks[i] = transpose(rotation_[i]) * blocks[i] * rotation_[i];
    });
    multigrid_.set_supports(std::move(blocks));
}

void WarpedPreconditioner::turn(std::span<const Vec3> x, const Threads& threads) {
    const std::vector<Mat3> F = deformation_gradients(model_, x, threads);
    threads.for_each(rotation_.size(), 64, [&](std::size_t i) {
        Mat3 mean;
        double volume = 0;
        for (std::uint32_t k = offset_[i]; k < offset_[i + 1]; ++k) {
            mean += model_.volumes[point_[k]] * F[point_[k]];
            volume += model_.volumes[point_[k]];
        }
        if (volume > 0) mean *= 1 / volume;
        const bool turns = volume > 0 && determinant(mean) > flat && multigrid_.free()[i] == Vec3{1, 1, 1};
        rotation_[i] = turns ? polar_rotation(mean) : Mat3::identity();
    });
}

void WarpedPreconditioner::apply(const std::vector<Vec3>& r, std::vector<Vec3>& z, const Threads& threads) {
    // Residuals get small beyond the range of single precision: they are scaled to one.
    const double size = std::sqrt(inner(r, r, threads));
    if (!(size > 0) || !std::isfinite(size)) return std::fill(z.begin(), z.end(), Vec3{});
    const std::span<const Vec3> free = multigrid_.free();
    std::vector<Vec3f>& turned = multigrid_.residual();
    threads.for_each(r.size(), node_chunk, [&](std::size_t i) {
        turned[i] = vector_cast<float>(transpose(rotation_[i]) * times(free[i], r[i]) / size);
    });
    multigrid_.cycle(threads);
    const std::vector<Vec3f>& result = multigrid_.result();
    threads.for_each(r.size(), node_chunk, [&](std::size_t i) {
        z[i] = size * times(free[i], rotation_[i] * vector_cast<double>(result[i]));
    });
}

}  // namespace phyxel
