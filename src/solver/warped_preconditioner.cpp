#include "solver/warped_preconditioner.h"

#include <algorithm>
#include <cmath>

#include "solver/nodal_vectors.h"

namespace phyxel {

WarpedPreconditioner::WarpedPreconditioner(const Model& model, const Constraints& constraints, const Threads& threads)
    : multigrid_(model, constraints, threads),
      rotations_(model, threads),
      rotation_(model.rest.size(), Mat3::identity()) {}

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
    rotations_.find(
        x, threads,
        [&](std::size_t i) {
            return multigrid_.free()[i] == Vec3{1, 1, 1};
        },
        rotation_);
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
