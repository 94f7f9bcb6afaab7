#include "solver/nodal_rotations.h"

#include <algorithm>

#include "base/eigen3.h"
#include "base/polar.h"

namespace phyxel {
namespace {

constexpr double nearest_distance = 1.01;  ///< [spacings]
constexpr double least_extent = 0.05;      ///< of a neighbourhood's squared extents, against the largest of them
constexpr double flat_frame = 0.1;         ///< of det F, below which a node has no frame of its own

/// Nodes that the points of each node's own cells see, ascending: none beyond a gap.
std::vector<std::vector<std::uint32_t>> neighborhoods(const Model& m) {
    const Stencils& st = m.stencils;
    std::vector<std::vector<std::uint32_t>> around(m.rest.size());
    for (const Stencils::Block& block : st.blocks)
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q)
            for (const std::uint32_t node : m.sampling.cell_nodes[m.sampling.point_cell[q]])
                if (node != no_index)
                    for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k)
                        around[node].push_back(st.slot_node[block.slot_begin + st.local[k]]);
    for (std::uint32_t i = 0; i < around.size(); ++i) {
        std::vector<std::uint32_t>& list = around[i];
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        std::erase(list, i);
    }
    return around;
}

/// sum (X_j - X_i) (x) (X_j - X_i)
Mat3 moment_of(const Model& m, std::size_t i, std::span<const std::uint32_t> nodes) {
    Mat3 moment;
    for (const std::uint32_t j : nodes) moment += outer(m.rest[j] - m.rest[i], m.rest[j] - m.rest[i]);
    return moment;
}

bool spans_space(const Mat3& moment) {
    const Vec3 extent = symmetric_eigen(moment).values;
    const auto [least, most] = std::minmax({extent.x, extent.y, extent.z});
    return least > least_extent * most;
}

}  // namespace

NodalRotations::NodalRotations(const Model& m, const Threads& threads) {
    std::vector<std::vector<std::uint32_t>> around = neighborhoods(m);
    std::vector<Mat3> inverse_moment(around.size());
    threads.for_each(around.size(), 64, [&](std::size_t i) {
        std::vector<std::uint32_t> nearest;
        for (const std::uint32_t j : around[i])
            if (norm(m.rest[j] - m.rest[i]) <= nearest_distance * m.sampling.spacing) nearest.push_back(j);
        if (spans_space(moment_of(m, i, nearest))) around[i] = nearest;
        const Mat3 moment = moment_of(m, i, around[i]);
        if (spans_space(moment)) inverse_moment[i] = inverse(moment);  // else thin: F is zero, no rotation is found
    });
    for (std::size_t i = 0; i < around.size(); ++i) {
        for (const std::uint32_t j : around[i]) gradient_.push_back(inverse_moment[i] * (m.rest[j] - m.rest[i]));
        node_.insert(node_.end(), around[i].begin(), around[i].end());
        offset_.push_back(static_cast<std::uint32_t>(node_.size()));
    }
}

Mat3 NodalRotations::rotation_of(std::size_t i, std::span<const Vec3> x) const {
    Mat3 F;
    for (std::uint32_t k = offset_[i]; k < offset_[i + 1]; ++k) F += outer(x[node_[k]] - x[i], gradient_[k]);
    return determinant(F) > flat_frame ? polar_rotation(F) : Mat3{};
}

void NodalRotations::follow_neighbors(std::span<Mat3> rotation) const {
    std::vector<std::pair<std::size_t, Mat3>> found;
    for (std::size_t i = 0; i < rotation.size(); ++i) {
        if (!(rotation[i] == Mat3{})) continue;
        Mat3 sum;
        for (std::uint32_t k = offset_[i]; k < offset_[i + 1]; ++k) sum += rotation[node_[k]];
        found.emplace_back(i, determinant(sum) > 0 ? polar_rotation(sum) : Mat3::identity());
    }
    for (const auto& [i, R] : found) rotation[i] = R;
}

}  // namespace phyxel
