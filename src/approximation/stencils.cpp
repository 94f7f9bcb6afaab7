#include "approximation/stencils.h"

#include <algorithm>
#include <cmath>

#include "approximation/box_grid.h"
#include "approximation/consistency.h"
#include "approximation/embedded_points.h"
#include "approximation/moving_least_squares.h"
#include "approximation/support_search.h"
#include "base/scratch_pool.h"

namespace phyxel {
namespace {

using Index3 = std::array<std::int32_t, 3>;

/// The stencil of a point deep inside of the lattice, up to translation.
struct Template {
    struct Neighbor {
        Index3 box;  ///< of a cell that holds the node, relative to the point's
        int slot;    ///< of the node in that cell
    };
    std::vector<Neighbor> neighbors;
    std::vector<double> share;  ///< Shepard weights, sum 1
    std::uint32_t gradient_begin = 0;
};

/// What the build of one block leaves behind until blocks are joined.
struct BlockBuild {
    std::vector<std::uint32_t> slot_node;
    std::vector<double> slot_volume;   ///< [slots] Shepard share of the block's volumes
    std::vector<std::uint32_t> count;  ///< [points] pairs
    std::vector<std::uint32_t> node;   ///< [pairs]
    std::vector<std::uint16_t> local;  ///< [pairs]
    std::vector<Vec3> gradient;        ///< [pairs of irregular points]
    std::vector<float> support;
    std::size_t widened = 0, deficient = 0;
    Vec3 deficient_place{};
};

struct Workspace {
    explicit Workspace(const Sampling& s) : search(s), slot_of(s.nodes.size(), no_index) {}
    SupportSearch search;
    Support support;
    ShapeFunctions shape;
    std::vector<std::uint32_t> slot_of;  ///< [nodes] slot in the block at work, or `no_index`
};

void shepard_shares(const Support& support, KernelShape kernel, std::vector<double>& share) {
    share.resize(support.offsets.size());
    double total = 0;
    for (std::size_t i = 0; i < share.size(); ++i)
        total += share[i] = weight(kernel, norm(support.offsets[i]) / support.radius);
    for (double& s : share) s /= total;
}

class Builder {
public:
    Builder(Sampling& sampling, const ApproximationSettings& settings, const Threads& threads)
        : s_(sampling),
          settings_(settings),
          threads_(threads),
          workspaces_([this] { return std::make_unique<Workspace>(s_); }) {}

    StencilBuild run() {
        // Half as wide again as a stencil: a block then has five slots for each of its cells, and they fit the cache.
        const int edge = std::clamp(static_cast<int>(std::ceil(3 * settings_.support / s_.pitch)), 4, 12);
        const std::vector<std::uint32_t> begin = sort_into_blocks(s_, edge);
        grid_.emplace(s_);
        deep_ = grid_->deep_cells(s_, static_cast<int>(std::ceil(settings_.support / s_.pitch)));
        make_templates();

        // Some blocks at a time: all of them, to be joined in the end, would take twice the memory.
        constexpr std::size_t batch = 8;
        start(begin.size() - 1);
        for (std::size_t first = 0; first + 1 < begin.size(); first += batch) {
            std::vector<BlockBuild> builds(std::min(batch, begin.size() - 1 - first));
            threads_.for_each(builds.size(), 1, [&](std::size_t b) {
                workspaces_.with(
                    [&](Workspace& work) { builds[b] = build_block(begin[first + b], begin[first + b + 1], work); });
            });
            join(std::span(begin).subspan(first), builds);
        }
        if (!s_.node_volumes.empty()) result_.node_volumes = s_.node_volumes;
        transpose_slots(result_.stencils);
        if (settings_.consistency_correction) correct();
        return std::move(result_);
    }

private:
    bool uses_template(std::uint32_t q) const {
        return s_.point_kind[q] != Sampling::irregular && deep_[s_.point_cell[q]];
    }

    /// Support and shape functions of a point, by the way its settings ask for.
    void fit(std::uint32_t q, Workspace& work) const {
        find_support(work.search, s_, settings_.kernel, settings_.support, s_.points[q], s_.point_cell[q],
                     work.support);
        MovingLeastSquares mls(settings_.kernel, work.support.radius);
        const std::uint32_t node = s_.point_node[q];
        const auto self = std::lower_bound(work.support.nodes.begin(), work.support.nodes.end(), node);
        if (settings_.nodal_gradients && node != no_index && self != work.support.nodes.end() && *self == node)
            mls.nodal_gradients(work.support.offsets, static_cast<std::size_t>(self - work.support.nodes.begin()),
                                work.shape);
        else mls.values_and_gradients(work.support.offsets, work.shape);
        for (Vec3& g : work.shape.gradient) g = s_.frame.direction_to_rest(g);
    }

    void make_templates() {
        templates_.resize(8);
        Workspace work(s_);
        for (std::uint32_t q = 0; q < s_.points.size(); ++q) {
            if (!uses_template(q) || !templates_[s_.point_kind[q]].neighbors.empty()) continue;
            Template& t = templates_[s_.point_kind[q]];
            fit(q, work);
            for (std::uint32_t n : work.support.nodes) {
                const std::uint32_t cell = s_.node_cell[n];
                Template::Neighbor neighbor{s_.cell_box[cell], s_.cell_nodes[cell][0] == n ? 0 : 1};
                for (int c = 0; c < 3; ++c) neighbor.box[c] -= s_.cell_box[s_.point_cell[q]][c];
                t.neighbors.push_back(neighbor);
            }
            shepard_shares(work.support, settings_.kernel, t.share);
            auto& gradient = result_.stencils.gradient;
            t.gradient_begin = static_cast<std::uint32_t>(gradient.size());
            gradient.insert(gradient.end(), work.shape.gradient.begin(), work.shape.gradient.end());
        }
    }

    void template_nodes(std::uint32_t q, std::vector<std::uint32_t>& nodes) const {
        const Index3& box = s_.cell_box[s_.point_cell[q]];
        for (const auto& [offset, slot] : templates_[s_.point_kind[q]].neighbors)
            nodes.push_back(
                s_.cell_nodes[grid_->cell({box[0] + offset[0], box[1] + offset[1], box[2] + offset[2]})][slot]);
    }

    BlockBuild build_block(std::uint32_t begin, std::uint32_t end, Workspace& work) const {
        BlockBuild b;
        std::vector<double> share, pair_volume;
        for (std::uint32_t q = begin; q < end; ++q) {
            const std::size_t before = b.node.size();
            const std::vector<double>* shares = &share;
            if (uses_template(q)) {
                template_nodes(q, b.node);
                shares = &templates_[s_.point_kind[q]].share;
                b.support.push_back(1);
            } else {
                fit(q, work);
                b.node.insert(b.node.end(), work.support.nodes.begin(), work.support.nodes.end());
                b.gradient.insert(b.gradient.end(), work.shape.gradient.begin(), work.shape.gradient.end());
                b.support.push_back(static_cast<float>(work.support.radius / settings_.support));
                shepard_shares(work.support, settings_.kernel, share);
                b.widened += work.support.widened;
                if (work.shape.rank < 3) ++b.deficient, b.deficient_place = s_.frame.to_rest(s_.points[q]);
            }
            b.count.push_back(static_cast<std::uint32_t>(b.node.size() - before));
            for (double w : *shares) pair_volume.push_back(w * s_.volumes[q]);
        }
        // Slots: the block's nodes, each once.
        for (std::uint32_t n : b.node)
            if (work.slot_of[n] == no_index) work.slot_of[n] = 0, b.slot_node.push_back(n);
        std::sort(b.slot_node.begin(), b.slot_node.end());
        for (std::uint32_t slot = 0; slot < b.slot_node.size(); ++slot) work.slot_of[b.slot_node[slot]] = slot;
        b.slot_volume.resize(b.slot_node.size());
        b.local.reserve(b.node.size());
        for (std::size_t k = 0; k < b.node.size(); ++k) {
            const std::uint32_t slot = work.slot_of[b.node[k]];
            b.local.push_back(static_cast<std::uint16_t>(slot));
            b.slot_volume[slot] += pair_volume[k];
        }
        for (std::uint32_t n : b.slot_node) work.slot_of[n] = no_index;
        b.node = {};
        return b;
    }

    /// Makes room for all; what is reserved beyond the need is never touched.
    void start(std::size_t blocks) {
        Stencils& st = result_.stencils;
        result_.node_volumes.assign(s_.nodes.size(), 0);
        std::size_t own = 0;
        for (std::uint32_t q = 0; q < s_.points.size(); ++q) own += !uses_template(q);
        const double reach = settings_.support / s_.pitch, density = s_.lattice == Lattice::bcc ? 0.25 : 1;
        const auto most = static_cast<std::size_t>(1.2 * density * 4.19 * reach * reach * reach) + 8;
        st.local.reserve(most * s_.points.size());
        st.gradient.reserve(st.gradient.size() + most * own);
        st.blocks.reserve(blocks);
        st.offset.push_back(0);
    }

    /// Appends blocks; `begin` holds their first points, and where the last one ends.
    void join(std::span<const std::uint32_t> begin, const std::vector<BlockBuild>& builds) {
        Stencils& st = result_.stencils;
        StencilReport& report = result_.report;
        for (std::size_t i = 0; i < builds.size(); ++i) {
            const BlockBuild& b = builds[i];
            const auto slot_begin = static_cast<std::uint32_t>(st.slot_node.size());
            st.slot_node.insert(st.slot_node.end(), b.slot_node.begin(), b.slot_node.end());
            st.blocks.push_back({begin[i], begin[i + 1], slot_begin, static_cast<std::uint32_t>(st.slot_node.size())});
            auto own_gradient = static_cast<std::uint32_t>(st.gradient.size());
            for (std::uint32_t q = begin[i]; q < begin[i + 1]; ++q) {
                const std::uint32_t count = b.count[q - begin[i]];
                const bool shared = uses_template(q);
                st.gradient_begin.push_back(shared ? templates_[s_.point_kind[q]].gradient_begin : own_gradient);
                if (!shared) own_gradient += count;
                st.offset.push_back(st.offset.back() + count);
            }
            st.local.insert(st.local.end(), b.local.begin(), b.local.end());
            st.gradient.insert(st.gradient.end(), b.gradient.begin(), b.gradient.end());
            st.support.insert(st.support.end(), b.support.begin(), b.support.end());
            for (std::size_t k = 0; k < b.slot_node.size(); ++k)
                result_.node_volumes[b.slot_node[k]] += b.slot_volume[k];
            report.widened += b.widened;
            if (b.deficient && !report.deficient) report.deficient_place = b.deficient_place;
            report.deficient += b.deficient;
        }
    }

    void transpose_slots(Stencils& st) const {
        st.node_slot_offset.assign(s_.nodes.size() + 1, 0);
        for (std::uint32_t n : st.slot_node) ++st.node_slot_offset[n + 1];
        for (std::size_t n = 0; n < s_.nodes.size(); ++n) st.node_slot_offset[n + 1] += st.node_slot_offset[n];
        st.node_slots.resize(st.slot_node.size());
        std::vector<std::uint32_t> next(st.node_slot_offset.begin(), st.node_slot_offset.end() - 1);
        for (std::uint32_t slot = 0; slot < st.slot_node.size(); ++slot)
            st.node_slots[next[st.slot_node[slot]]++] = slot;
    }

    /// r_i = b_i - sum_q V_q g_qi: closed-surface integral of phi_i n less the volume integral of its gradient.
    std::vector<Vec3> patch_residual() const {
        const Stencils& st = result_.stencils;
        std::vector<Vec3> residual(s_.nodes.size()), positions;
        constexpr std::size_t batch = 4096;
        for (std::size_t first = 0; first < s_.boundary.size(); first += batch) {
            const std::size_t count = std::min(batch, s_.boundary.size() - first);
            positions.clear();
            for (std::size_t p = first; p < first + count; ++p) positions.push_back(s_.boundary[p].position);
            const auto cells = std::span(s_.boundary_cell).subspan(first, count);
            const EmbeddedPoints boundary = embed(s_, settings_, positions, cells, Gradients::no, threads_);
            for (std::size_t p = 0; p < boundary.size(); ++p) {
                const Vec3 area = s_.frame.direction_to_rest(s_.boundary[first + p].area);
                for (std::uint32_t k = boundary.offset[p]; k < boundary.offset[p + 1]; ++k)
                    residual[boundary.node[k]] += boundary.phi[k] * area;
            }
        }
        for (const auto& block : st.blocks)
            for (std::uint32_t q = block.point_begin; q < block.point_end; ++q)
                for (std::uint32_t k = st.offset[q], g = st.gradient_begin[q]; k < st.offset[q + 1]; ++k, ++g)
                    residual[st.slot_node[block.slot_begin + st.local[k]]] -= s_.volumes[q] * st.gradient[g];
        return residual;
    }

    /// Symmetric correction of the points near the surface, so that a constant stress is in equilibrium with its
    /// tractions.
    void correct() {
        Stencils& st = result_.stencils;
        const std::vector<Vec3> residual = patch_residual();
        std::vector<Vec3> points;
        std::vector<double> volumes, support;
        std::vector<std::uint32_t> offset{0}, node;
        for (const auto& block : st.blocks)
            for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) {
                if (uses_template(q)) continue;
                points.push_back(s_.points[q]);
                volumes.push_back(s_.volumes[q]);
                support.push_back(settings_.support * static_cast<double>(st.support[q]));
                for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k)
                    node.push_back(st.slot_node[block.slot_begin + st.local[k]]);
                offset.push_back(static_cast<std::uint32_t>(node.size()));
            }
        if (points.empty()) return;
        // Gradients of a point's own follow the templates', in the order of the points: the zone's are one run.
        const std::span<Vec3> own = std::span(st.gradient).last(node.size());
        const ConsistencyInput input{s_.nodes, points, volumes, support, offset, node, residual, settings_.kernel};
        const ConsistencyReport done = make_consistent(input, own, threads_);
        result_.report.consistency_before = done.residual_before;
        result_.report.consistency_after = done.residual_after;
        result_.report.consistent = done.converged;
    }

    Sampling& s_;
    const ApproximationSettings& settings_;
    const Threads& threads_;
    ScratchPool<Workspace> workspaces_;
    std::optional<BoxGrid> grid_;
    std::vector<char> deep_;
    std::vector<Template> templates_;
    StencilBuild result_;
};

}  // namespace

KernelShape kernel_shape(const BodySettings& settings) {
    return settings.kernel.shape.value_or(settings.quadrature == Quadrature::nodes ? KernelShape::poly6
                                                                                   : KernelShape::quartic_spline);
}

double support_radius(const BodySettings& settings, double spacing) {
    const bool bcc = settings.lattice == Lattice::bcc;
    if (settings.kernel.neighbors > 0) {
        // Distances from a node of the infinite lattice, nearest first; the node itself is not counted.
        std::vector<double> distances;
        const int reach = 2 + static_cast<int>(std::cbrt(settings.kernel.neighbors));
        for (int k = -reach; k <= reach; ++k)
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i) {
                    const Vec3 corner = {double(i), double(j), double(k)};
                    if (i != 0 || j != 0 || k != 0) distances.push_back(norm(corner));
                    if (bcc) distances.push_back(norm(corner + Vec3{0.5, 0.5, 0.5}));
                }
        std::sort(distances.begin(), distances.end());
        double mean = 0;
        for (int n = 0; n < settings.kernel.neighbors; ++n) mean += distances[n] / settings.kernel.neighbors;
        return settings.kernel.dilation * mean * spacing;
    }
    // A body-centred lattice has two nodes a cell: the same number of neighbours at a support smaller by the cube root
    // of 2.
    const double standard = (settings.quadrature == Quadrature::grid ? 2.2 : 1.8) / (bcc ? std::cbrt(2.0) : 1);
    return (settings.kernel.support > 0 ? settings.kernel.support : standard) * spacing;
}

StencilBuild build_stencils(Sampling& sampling, const ApproximationSettings& settings, const Threads& threads) {
    return Builder(sampling, settings, threads).run();
}

}  // namespace phyxel
