#include "solver/galerkin.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/mesh_topology.h"

namespace phyxel {
namespace {

/// A coarse node's part in a quadrature point: row d is the gradient of its shape function for displacement along d
/// (they differ where only some directions are held).
struct CoarseGradient {
    std::uint32_t node = 0;  ///< local to the block
    Mat3 g;
};

/// K_IJ of one weighted point.
Mat3 stiffness_block(const Lame& lame, const Mat3& a, const Mat3& b) {
    Mat3 K;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) K(r, c) = lame.lambda * a(r, r) * b(c, c) + lame.mu * a(r, c) * b(c, r);
        K(r, r) += lame.mu * dot(a.rows[r], b.rows[r]);
    }
    return K;
}

/// Contributions of one block of points: a dense matrix over the coarse nodes that they touch.
struct BlockStiffness {
    std::vector<std::uint32_t> nodes;  ///< ascending
    std::vector<Mat3> matrix;          ///< [nodes x nodes]

    void add(const std::vector<CoarseGradient>& stencil, double volume, const Lame& lame) {
        const Lame weighted{volume * lame.lambda, volume * lame.mu};
        for (const CoarseGradient& a : stencil)
            for (const CoarseGradient& b : stencil)
                matrix[a.node * nodes.size() + b.node] += stiffness_block(weighted, a.g, b.g);
    }
};

/// Points whose coarse stencils are found one after the other.
class CoarseStencils {
public:
    CoarseStencils(const Model& m, const Stencils::Block& block, const Coarsening& coarse, std::span<const Vec3> free)
        : m_(m), block_(block), free_(free) {
        const SparseRows& P = coarse.prolongation;
        for (std::uint32_t s = block.slot_begin; s < block.slot_end; ++s) {
            const std::uint32_t i = m.stencils.slot_node[s];
            nodes.insert(nodes.end(), P.column.begin() + P.offset[i], P.column.begin() + P.offset[i + 1]);
        }
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        for (std::uint32_t s = block.slot_begin; s < block.slot_end; ++s) {
            const std::uint32_t i = m.stencils.slot_node[s];
            for (std::uint32_t k = P.offset[i]; k < P.offset[i + 1]; ++k) {
                const auto at = std::lower_bound(nodes.begin(), nodes.end(), P.column[k]) - nodes.begin();
                parents_.push_back({static_cast<std::uint32_t>(at), P.value[k]});
            }
            parents_offset_.push_back(static_cast<std::uint32_t>(parents_.size()));
        }
        sums_.resize(nodes.size());
        used_.resize(nodes.size());
    }

    /// Adds the gradients of point q.
    void add(std::uint32_t q) {
        const Stencils& st = m_.stencils;
        for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k) {
            const Vec3& g = st.gradient[st.gradient_begin[q] + k - st.offset[q]];
            const std::uint32_t slot = st.local[k];
            const Vec3& mask = free_[st.slot_node[block_.slot_begin + slot]];
            const Mat3 masked = {{mask.x * g, mask.y * g, mask.z * g}};
            for (std::uint32_t p = parents_offset_[slot]; p < parents_offset_[slot + 1]; ++p) {
                const std::uint32_t I = parents_[p].node;
                if (!used_[I]) used_[I] = true, touched_.push_back(I);
                sums_[I] += parents_[p].weight * masked;
            }
        }
    }

    /// What was added since the last call.
    const std::vector<CoarseGradient>& take() {
        stencil_.clear();
        std::sort(touched_.begin(), touched_.end());
        for (std::uint32_t I : touched_) {
            stencil_.push_back({I, sums_[I]});
            sums_[I] = {};
            used_[I] = false;
        }
        touched_.clear();
        return stencil_;
    }

    std::vector<std::uint32_t> nodes;  ///< coarse nodes of the block, ascending

private:
    struct Parent {
        std::uint32_t node;
        double weight;
    };
    const Model& m_;
    const Stencils::Block& block_;
    std::span<const Vec3> free_;
    std::vector<std::uint32_t> parents_offset_{0};  ///< [slots + 1]
    std::vector<Parent> parents_;
    std::vector<Mat3> sums_;
    std::vector<char> used_;
    std::vector<std::uint32_t> touched_;
    std::vector<CoarseGradient> stencil_;
};

BlockStiffness block_stiffness(const Model& m, const Stencils::Block& block, const Coarsening& coarse,
                               std::span<const Vec3> free) {
    CoarseStencils stencils(m, block, coarse, free);
    BlockStiffness result{stencils.nodes, std::vector<Mat3>(stencils.nodes.size() * stencils.nodes.size())};
    for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
        stencils.add(q);
        result.add(stencils.take(), m.volumes[q], m.point_material(q).lame);
    }
    return result;
}

}  // namespace

std::vector<std::uint32_t> separate_parts(const Sampling& sampling) {
    DisjointSets parts(sampling.cell_centers.size());
    for (std::uint32_t cell = 0; cell < sampling.cell_centers.size(); ++cell)
        for (std::uint32_t k = sampling.neighbor_offset[cell]; k < sampling.neighbor_offset[cell + 1]; ++k)
            parts.unite(cell, sampling.neighbors[k]);
    std::vector<std::uint32_t> of_nodes;
    for (std::uint32_t cell : sampling.node_cell) of_nodes.push_back(parts.find(cell));
    return of_nodes;
}

Coarsening coarsen(std::span<const Vec3> places, std::span<const std::uint32_t> parts) {
    // Weights along each axis: one coarse node where the place falls on it, two elsewhere.
    constexpr double on_it = 1e-6;
    struct Key {
        std::array<std::int32_t, 3> place;
        std::uint32_t part;
        auto operator<=>(const Key&) const = default;
    };
    std::map<Key, std::uint32_t> index;
    struct Weight {
        Key key;
        double value;
    };
    std::vector<std::vector<Weight>> rows(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        std::array<std::vector<std::pair<std::int32_t, double>>, 3> along;
        for (std::size_t d = 0; d < 3; ++d) {
            const double u = 0.5 * places[i][d], below = std::floor(u + on_it), t = u - below;
            const auto whole = static_cast<std::int32_t>(below);
            if (t > on_it) along[d] = {{whole, 1 - t}, {whole + 1, t}};
            else along[d] = {{whole, 1.0}};
        }
        for (const auto& [x, wx] : along[0])
            for (const auto& [y, wy] : along[1])
                for (const auto& [z, wz] : along[2]) {
                    rows[i].push_back({{{x, y, z}, parts[i]}, wx * wy * wz});
                    index[{{x, y, z}, parts[i]}] = 0;
                }
    }
    Coarsening coarse;
    for (auto& [key, number] : index) {
        number = static_cast<std::uint32_t>(coarse.places.size());
        coarse.places.push_back(key.place);
        coarse.parts.push_back(key.part);
    }
    coarse.prolongation.offset.push_back(0);
    for (const auto& row : rows) {
        for (const Weight& w : row) {
            coarse.prolongation.column.push_back(index[w.key]);
            coarse.prolongation.value.push_back(w.value);
        }
        coarse.prolongation.offset.push_back(static_cast<std::uint32_t>(coarse.prolongation.column.size()));
    }
    coarse.restriction = transposed(coarse.prolongation, coarse.places.size());
    return coarse;
}

BlockRows galerkin_stiffness(const Model& m, const Coarsening& coarse, std::span<const Vec3> free,
                             const Threads& threads) {
    constexpr std::size_t at_once = 16;  // blocks whose dense matrices are held in memory together
    BlockRows rows(coarse.places.size());
    const auto& blocks = m.stencils.blocks;
    for (std::size_t begin = 0; begin < blocks.size(); begin += at_once) {
        const std::size_t end = std::min(begin + at_once, blocks.size());
        std::vector<BlockStiffness> parts(end - begin);
        threads.for_each(end - begin, 1,
                         [&](std::size_t b) { parts[b] = block_stiffness(m, blocks[begin + b], coarse, free); });
        for (const BlockStiffness& part : parts)
            for (std::size_t I = 0; I < part.nodes.size(); ++I)
                for (std::size_t J = 0; J < part.nodes.size(); ++J) {
                    const Mat3& K = part.matrix[I * part.nodes.size() + J];
                    if (!(K == Mat3{})) rows.add(part.nodes[I], part.nodes[J], K);
                }
    }
    return rows;
}

BlockRows galerkin_product(const BlockMatrix& A, const Coarsening& coarse) {
    const SparseRows& P = coarse.prolongation;
    BlockRows rows(coarse.places.size());
    for (std::uint32_t i = 0; i < A.rows(); ++i) {
        // P^T (A P): the row of A P first, over few coarse nodes.
        std::map<std::uint32_t, Mat3> row;
        for (std::size_t k = A.offset[i]; k < A.offset[i + 1]; ++k)
            for (std::uint32_t p = P.offset[A.column[k]]; p < P.offset[A.column[k] + 1]; ++p)
                row[P.column[p]] += P.value[p] * to_double(A.value[k]);
        for (std::uint32_t p = P.offset[i]; p < P.offset[i + 1]; ++p)
            for (const auto& [J, block] : row) rows.add(P.column[p], J, P.value[p] * block);
    }
    return rows;
}

}  // namespace phyxel
