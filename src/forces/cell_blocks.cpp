#include "forces/cell_blocks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/polar.h"

namespace phyxel {
namespace {

constexpr int block_edge = 8;  ///< cells a block along each axis: its slots and one chunk fit the second-level cache
constexpr std::size_t gathered_chunk = 512;
constexpr std::size_t most_samples = 12;  ///< nodes that tell how a block is turned

/// Whether gradients, as floats and none of them shared, are more than the cache holds. (Those of one point a cell are
/// few.)
bool has_families(const Model& m, const CellOptions& options) {
    return options.points == CellPoints::all && sizeof(Vec3f) * m.stencils.pairs() > options.cached_gradients;
}

int block_of(int cell) { return cell >= 0 ? cell / block_edge : -1 - (-1 - cell) / block_edge; }

}  // namespace

CellBlocks::CellBlocks(const Model& model, const Threads& threads, const CellOptions& options)
    : groups_(group_cells(model, options.tolerance, has_families(model, options), threads)),
      lanes_(cell_lanes(options.instructions)),
      kernel_(cell_kernel(options.instructions)),
      points_(options.points),
      length_(model.sampling.spacing) {
    // Groups by block, law and shape.
    std::vector<std::uint32_t> order(groups_.groups.size());
    for (std::uint32_t g = 0; g < order.size(); ++g) order[g] = g;
    const auto block_key = [&](std::uint32_t g) {
        const CellGroups::Index3& cell = groups_.groups[g].cell;
        return std::array{block_of(cell[0]), block_of(cell[1]), block_of(cell[2])};
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto key = [&](std::uint32_t g) {
            return std::tuple(block_key(g), groups_.groups[g].kind(), groups_.groups[g].shape, g);
        };
        return key(a) < key(b);
    });
    std::vector<std::size_t> begin;
    for (std::size_t i = 0; i < order.size(); ++i)
        if (i == 0 || block_key(order[i]) != block_key(order[i - 1])) begin.push_back(i);
    begin.push_back(order.size());

    shapes_ = pack_shapes(model, groups_, lanes_, points_, threads);
    blocks_.resize(begin.size() - 1);
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        const auto members = std::span(order).subspan(begin[b], begin[b + 1] - begin[b]);
        blocks_[b] = pack_block(model, groups_, shapes_, members, lanes_, points_);
    });
    for (const CellBlock& block : blocks_) matches_model_ &= block.complete;
    number_slots(model.rest.size());
    count(model);
    groups_.node = {}, groups_.place = {}, groups_.point_slot_begin = {};  // never needed again
    set_materials(model, threads);
}

void CellBlocks::number_slots(std::size_t nodes) {
    slot_begin_.assign(1, 0);
    node_slot_offset_.assign(nodes + 1, 0);
    for (const CellBlock& block : blocks_) {
        slot_begin_.push_back(slot_begin_.back() + static_cast<std::uint32_t>(block.slot_node.size()));
        for (std::size_t s = 1; s < block.slot_node.size(); ++s) ++node_slot_offset_[block.slot_node[s] + 1];
    }
    for (std::size_t n = 0; n < nodes; ++n) node_slot_offset_[n + 1] += node_slot_offset_[n];
    node_slots_.resize(node_slot_offset_[nodes]);
    std::vector<std::uint32_t> next(node_slot_offset_.begin(), node_slot_offset_.end() - 1);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (std::uint32_t s = 1; s < blocks_[b].slot_node.size(); ++s)
            node_slots_[next[blocks_[b].slot_node[s]]++] = slot_begin_[b] + s;
    u_.resize(slot_begin_.back());
    f_.resize(slot_begin_.back());
}

void CellBlocks::count(const Model& model) {
    counts_.groups = groups_.groups.size();
    counts_.pairs = model.stencils.pairs();
    for (const CellBlock& block : blocks_) {
        counts_.chunks += block.chunks.size();
        for (const CellChunk& chunk : block.chunks) {
            counts_.uniform_chunks += chunk.kind == ChunkKind::uniform;
            counts_.similar_chunks += chunk.kind == ChunkKind::similar;
            counts_.lane_pairs += chunk.pair_begin[8] * lanes_;
            largest_window_ = std::max<std::size_t>(largest_window_, chunk.entries);
        }
        counts_.bytes +=
            4 * block.gradient.size() + 2 * block.difference.size() + 2 * block.entry.size() + 2 * block.slot.size();
    }
    for (const auto* shapes : {&shapes_.exact, &shapes_.similar})
        for (const CellShape& shape : *shapes) counts_.bytes += 4 * shape.gradient.size() + 2 * shape.entry.size();
}

void CellBlocks::set_materials(const Model& model, const Threads& threads) {
    double largest = 0;
    bool has_volume_stiffness = false;
    for (std::size_t q = 0; q < model.volumes.size(); ++q) {
        const MaterialPoint& point = model.point_material(q);
        largest = std::max(
            largest, model.volumes[q] * std::max({point.lame.mu, std::abs(point.lame.lambda), point.volume_stiffness}));
        has_volume_stiffness |= point.volume_stiffness > 0;
    }
    stiffness_ = largest > 0 ? largest : 1;
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        CellBlock& block = blocks_[b];
        const std::size_t points = 8 * lanes_;
        block.lame.assign(block.chunks.size() * 2 * points, 0);
        block.volume_stiffness.assign(has_volume_stiffness ? block.chunks.size() * points : 0, 0);
        block.share.assign(model.dilatation.empty() ? 0 : block.chunks.size() * points, 0);
        block.join.assign(model.dilatation.empty() ? 0 : block.chunks.size() * lanes_, 0);
        for (std::size_t c = 0; c < block.chunks.size(); ++c) {
            CellChunk& chunk = block.chunks[c];
            chunk.lame = &block.lame[c * 2 * points];
            chunk.volume_stiffness = has_volume_stiffness ? &block.volume_stiffness[c * points] : nullptr;
            for (std::size_t lane = 0; lane < lanes_; ++lane) {
                const std::uint32_t g = block.lane_group[c * lanes_ + lane];
                if (g != no_index) fill_moduli(model, groups_.groups[g], block, c, lane);
            }
            join_lanes(block, c);
        }
    });
}

/// Tells the lanes of a chunk which of them see the same dilatation cell.
void CellBlocks::join_lanes(CellBlock& block, std::size_t chunk) const {
    const std::uint32_t* g = &block.lane_group[chunk * lanes_];
    block.chunks[chunk].join = nullptr;
    if (!groups_.groups[g[0]].joined) return;
    std::uint8_t* join = &block.join[chunk * lanes_];
    block.chunks[chunk].join = join;
    const auto cell = [&](std::size_t lane) {
        return g[lane] == no_index ? no_index : groups_.groups[g[lane]].dilatation_cell;
    };
    for (std::size_t lane = 0; lane < lanes_; ++lane)
        while (cell(join[lane]) != cell(lane)) ++join[lane];
}

void CellBlocks::fill_moduli(const Model& model, const CellGroups::Group& group, CellBlock& block, std::size_t chunk,
                             std::size_t lane) const {
    const bool shared = group.dilatation_cell != no_index && points_ == CellPoints::all;
    if (shared) block.chunks[chunk].share = &block.share[chunk * 8 * lanes_];
    for (std::size_t octant = 0; octant < 8; ++octant) {
        const std::uint32_t q = group.point[octant];
        if (q == no_index) continue;
        const MaterialPoint& point = model.point_material(q);
        const double lambda = shared ? model.dilatation.lambda[group.dilatation_cell] : point.lame.lambda;
        const double V = model.volumes[q] / stiffness_;
        const std::size_t at = (chunk * 8 + (points_ == CellPoints::all ? octant : 0)) * lanes_;
        block.lame[2 * at + lane] += static_cast<float>(V * lambda);
        block.lame[2 * at + lanes_ + lane] += static_cast<float>(V * point.lame.mu);
        if (!block.volume_stiffness.empty())
            block.volume_stiffness[at + lane] = static_cast<float>(V * point.volume_stiffness);
        if (shared)
            block.share[at + lane] =
                static_cast<float>(model.volumes[q] / model.dilatation.volume[group.dilatation_cell]);
    }
}

namespace {

bool is_finite(const Mat3& A) { return is_finite(A.rows[0]) && is_finite(A.rows[1]) && is_finite(A.rows[2]); }

/// A rotation near to how some nodes of a block are turned.
Mat3 frame_of(const Model& m, std::span<const std::uint32_t> nodes, std::span<const Vec3> x) {
    const std::size_t stride = std::max<std::size_t>(1, nodes.size() / most_samples);
    const Vec3 x0 = x[nodes[0]], X0 = m.rest[nodes[0]];
    Vec3 x_sum{}, X_sum{};
    Mat3 A;
    double count = 0;
    for (std::size_t s = 0; s < nodes.size(); s += stride) {
        const Vec3 dx = x[nodes[s]] - x0, dX = m.rest[nodes[s]] - X0;
        A += outer(dx, dX);
        x_sum += dx, X_sum += dX;
        ++count;
    }
    A -= (1 / count) * outer(x_sum, X_sum);
    A *= 1 / (m.sampling.spacing * m.sampling.spacing);
    return is_finite(A) ? polar_rotation(A) : Mat3::identity();
}

}  // namespace

/// Displacements from the rest shape moved to where the block is, into the block's slots; returns how it was turned.
Mat3 CellBlocks::move_to_slots(const Model& m, std::size_t b, std::span<const Vec3> x) const {
    const std::span nodes = std::span(blocks_[b].slot_node).subspan(1);
    Float4* u = &u_[slot_begin_[b]];
    const Mat3 R = blocks_[b].moves ? frame_of(m, nodes, x) : Mat3::identity();
    const Mat3 Rt = (1 / length_) * transpose(R);
    const Vec3 x0 = x[nodes[0]], X0 = m.rest[nodes[0]];
    u[0] = Float4{};
    for (std::size_t s = 0; s < nodes.size(); ++s) {
        const Vec3 d = Rt * (x[nodes[s]] - x0) - (1 / length_) * (m.rest[nodes[s]] - X0);
        u[s + 1] = {{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), 0}};
    }
    return R;
}

/// beta v, less that of the first slot, in the frame of the displacements.
void CellBlocks::rates_to_slots(std::size_t b, const Mat3& R, std::span<const Vec3> v, double beta) const {
    const std::span nodes = std::span(blocks_[b].slot_node).subspan(1);
    Float4* rate = &rate_[slot_begin_[b]];
    const Mat3 Rt = (beta / length_) * transpose(R);
    rate[0] = Float4{};
    for (std::size_t s = 0; s < nodes.size(); ++s) {
        const Vec3 w = Rt * (v[nodes[s]] - v[nodes[0]]);
        rate[s + 1] = {{static_cast<float>(w.x), static_cast<float>(w.y), static_cast<float>(w.z), 0}};
    }
}

double CellBlocks::run(std::size_t b, CellTask task) const {
    thread_local std::vector<float> scratch;
    scratch.resize(std::max(scratch.size(), 6 * largest_window_ * lanes_));
    Float4* f = &f_[slot_begin_[b]];
    if (task != CellTask::energy) std::fill(f, f + blocks_[b].slot_node.size(), Float4{});
    const Float4* rate = task == CellTask::damped_forces ? &rate_[slot_begin_[b]] : nullptr;
    return kernel_(blocks_[b].chunks, task, {&u_[slot_begin_[b]], rate, f, scratch.data()});
}

double CellBlocks::forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) const {
    return find_forces(m, x, {}, 0, threads, f);
}

double CellBlocks::damped_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                                 const Threads& threads, std::span<Vec3> f) const {
    rate_.resize(u_.size());
    return find_forces(m, x, v, beta, threads, f);
}

double CellBlocks::find_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                               const Threads& threads, std::span<Vec3> f) const {
    const double energy = threads.sum(blocks_.size(), 1, [&](std::size_t b) {
        const Mat3 R = move_to_slots(m, b, x);
        if (!v.empty()) rates_to_slots(b, R, v, beta);
        const double stored = run(b, v.empty() ? CellTask::forces : CellTask::damped_forces);
        if (!blocks_[b].moves) return stored;
        Mat3f turn;
        for (std::size_t r = 0; r < 3; ++r) turn.rows[r] = vector_cast<float>(R.rows[r]);
        for (std::uint32_t s = slot_begin_[b]; s < slot_begin_[b + 1]; ++s) {
            const Vec3f force = turn * Vec3f{f_[s].lane[0], f_[s].lane[1], f_[s].lane[2]};
            f_[s] = {{force.x, force.y, force.z, 0}};
        }
        return stored;
    });
    const double unit = stiffness_ / length_;
    threads.for_each(f.size(), gathered_chunk, [&](std::size_t i) {
        Vec3 sum{};
        for (std::uint32_t k = node_slot_offset_[i]; k < node_slot_offset_[i + 1]; ++k) {
            const Float4& force = f_[node_slots_[k]];
            sum += Vec3{double(force.lane[0]), double(force.lane[1]), double(force.lane[2])};
        }
        f[i] = unit * sum;
    });
    return stiffness_ * energy;
}

double CellBlocks::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) const {
    return stiffness_ * threads.sum(blocks_.size(), 1, [&](std::size_t b) {
        move_to_slots(m, b, x);
        return run(b, CellTask::energy);
    });
}

void CellBlocks::rest_action(const Model&, std::span<const Vec3f> d, const Threads& threads,
                             std::span<Vec3f> out) const {
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        Float4* u = &u_[slot_begin_[b]];
        const std::vector<std::uint32_t>& node = blocks_[b].slot_node;
        const Vec3f origin = d[node[1]];
        u[0] = Float4{};
        for (std::size_t s = 1; s < node.size(); ++s) {
            const Vec3f v = d[node[s]] - origin;
            u[s] = {{v.x, v.y, v.z, 0}};
        }
        run(b, CellTask::rest_action);
    });
    const auto unit = static_cast<float>(stiffness_ / (length_ * length_));
    threads.for_each(out.size(), gathered_chunk, [&](std::size_t i) {
        Vec3f sum{};
        for (std::uint32_t k = node_slot_offset_[i]; k < node_slot_offset_[i + 1]; ++k) {
            const Float4& v = f_[node_slots_[k]];
            sum += Vec3f{v.lane[0], v.lane[1], v.lane[2]};
        }
        out[i] = unit * sum;
    });
}

}  // namespace phyxel
