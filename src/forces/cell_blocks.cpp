#include "forces/cell_blocks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/polar.h"

namespace phyxel {
namespace {

constexpr int block_edge = 8;  ///< cells a block along each axis: its slots and one chunk fit the second-level cache
constexpr std::size_t node_chunk = 512;
constexpr std::size_t most_samples = 12;  ///< nodes that tell how a block is turned

int block_of(int cell) { return cell >= 0 ? cell / block_edge : -1 - (-1 - cell) / block_edge; }

}  // namespace

/// Deals the groups of one block to lanes and lays out what the kernel reads.
struct CellBlocks::BlockBuilder {
    CellBlocks& whole;
    const Model& m;
    std::span<const std::uint32_t> members;  ///< groups, those of one law and shape after each other
    Block& block;
    std::vector<std::uint32_t>& slot_node;  ///< of this block alone

    /// Chunks of groups: `uniform` ones first.
    struct Lanes {
        std::vector<std::uint32_t> groups;
        bool uniform;
    };
    std::vector<Lanes> chunks;
    bool complete = true;  ///< no dilatation cell is cut

    const CellGroups::Group& group(std::uint32_t g) const { return whole.groups_.groups[g]; }

    void deal() {
        const std::size_t lanes = whole.lanes_;
        std::vector<std::uint32_t> rest;
        for (std::size_t begin = 0, end; begin < members.size(); begin = end) {
            end = begin + 1;
            while (end < members.size() && group(members[end]).shape == group(members[begin]).shape) ++end;
            for (; end - begin >= lanes - lanes / 4; begin += std::min(lanes, end - begin)) {
                const auto first = members.begin() + static_cast<std::ptrdiff_t>(begin);
                chunks.push_back({{first, first + static_cast<std::ptrdiff_t>(std::min(lanes, end - begin))}, true});
            }
            rest.insert(rest.end(), members.begin() + static_cast<std::ptrdiff_t>(begin),
                        members.begin() + static_cast<std::ptrdiff_t>(end));
        }
        // Windows of one size lie together, so that few lanes wait for entries that others have; parts of one
        // dilatation cell in one chunk.
        std::stable_sort(rest.begin(), rest.end(), [&](std::uint32_t a, std::uint32_t b) {
            const auto key = [&](std::uint32_t g) {
                const CellGroups::Group& of = group(g);
                return std::tuple(of.kind(), of.joined ? of.dilatation_cell : 0, whole.groups_.window_size(of),
                                  of.cell);
            };
            return key(a) < key(b);
        });
        for (std::size_t begin = 0, end; begin < rest.size(); begin = end) {
            const CellGroups::Group& first = group(rest[begin]);
            end = begin + 1;
            while (first.joined && end < rest.size() && group(rest[end]).dilatation_cell == first.dilatation_cell)
                ++end;
            const bool fits = !chunks.empty() && !chunks.back().uniform &&
                              group(chunks.back().groups[0]).kind() == first.kind() &&
                              chunks.back().groups.size() + (end - begin) <= lanes;
            if (!fits) chunks.push_back({{}, false});
            for (std::size_t i = begin; i < end; ++i) {
                if (chunks.back().groups.size() == lanes) chunks.push_back({{}, false}), complete = false;
                chunks.back().groups.push_back(rest[i]);
            }
        }
    }

    void collect_slots() {
        for (std::uint32_t g : members)
            slot_node.insert(slot_node.end(), whole.groups_.node.begin() + group(g).window_begin,
                             whole.groups_.node.begin() + group(g).window_end);
        std::sort(slot_node.begin(), slot_node.end());
        slot_node.erase(std::unique(slot_node.begin(), slot_node.end()), slot_node.end());
        slot_node.insert(slot_node.begin(), no_index);
    }

    std::uint16_t slot_of(std::uint32_t node) const {
        return static_cast<std::uint16_t>(std::lower_bound(slot_node.begin() + 1, slot_node.end(), node) -
                                          slot_node.begin());
    }

    /// The places of all windows of a chunk, each once.
    std::vector<CellGroups::Place> joint_window(const Lanes& chunk) const {
        std::vector<CellGroups::Place> window;
        for (std::uint32_t g : chunk.groups)
            window.insert(window.end(), whole.groups_.place.begin() + group(g).window_begin,
                          whole.groups_.place.begin() + group(g).window_end);
        std::sort(window.begin(), window.end());
        window.erase(std::unique(window.begin(), window.end()), window.end());
        return window;
    }

    /// Slots of a window, and the entry of each of the group's own in the joint window.
    std::vector<std::uint32_t> add_window(const Lanes& chunk, std::size_t lane,
                                          const std::vector<CellGroups::Place>& window, std::size_t slot_begin) {
        const CellGroups::Group& g = group(chunk.groups[lane]);
        std::vector<std::uint32_t> entry_of;
        std::size_t e = 0;
        for (std::uint32_t own = g.window_begin; own < g.window_end; ++own) {
            while (window[e] != whole.groups_.place[own]) ++e;
            entry_of.push_back(static_cast<std::uint32_t>(e));
            block.slot[slot_begin + e * whole.lanes_ + lane] = slot_of(whole.groups_.node[own]);
        }
        return entry_of;
    }

    /// Appends the pairs of a chunk, point by point: entries that any lane sees, with the gradients of `lanes` lanes.
    static void add_pairs(const std::vector<Vec3f>& dense, std::size_t entries, std::size_t lanes,
                          std::vector<std::uint16_t>& entry, std::vector<float>& gradient,
                          std::array<std::uint32_t, 9>& pair_begin, std::size_t first_pair) {
        for (std::size_t point = 0; point < 8; ++point) {
            pair_begin[point] = static_cast<std::uint32_t>(entry.size() - first_pair);
            for (std::size_t e = 0; e < entries; ++e) {
                const Vec3f* g = &dense[(point * entries + e) * lanes];
                if (std::all_of(g, g + lanes, [](const Vec3f& v) { return v == Vec3f{}; })) continue;
                entry.push_back(static_cast<std::uint16_t>(e));
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t lane = 0; lane < lanes; ++lane) gradient.push_back(g[lane][c]);
            }
        }
        pair_begin[8] = static_cast<std::uint32_t>(entry.size() - first_pair);
    }

    void add_gradients(std::uint32_t g, const std::vector<std::uint32_t>& entry_of, std::size_t entries,
                       std::size_t lanes, std::size_t lane, std::vector<Vec3f>& dense) const {
        std::vector<Vec3> spread(entry_of.size());
        for (std::size_t octant = 0; octant < 8; ++octant) {
            if (group(g).point[octant] == no_index) continue;
            whole.groups_.spread_gradients(m, group(g), octant, spread);
            for (std::size_t e = 0; e < spread.size(); ++e)
                dense[(octant * entries + entry_of[e]) * lanes + lane] = vector_cast<float>(spread[e]);
        }
    }

    void run() {
        deal();
        collect_slots();
        const std::size_t lanes = whole.lanes_;
        struct Begin {
            std::size_t slot, entry, gradient;
        };
        std::vector<Begin> begins;
        block.lane_group.assign(chunks.size() * lanes, no_index);
        for (std::size_t c = 0; c < chunks.size(); ++c) {
            const Lanes& chunk = chunks[c];
            CellChunk packed{};
            packed.uniform = chunk.uniform;
            packed.law = group(chunk.groups[0]).law;
            const std::vector<CellGroups::Place> window = joint_window(chunk);
            packed.entries = static_cast<std::uint32_t>(window.size());
            begins.push_back({block.slot.size(), block.entry.size(), block.gradient.size()});
            block.slot.resize(block.slot.size() + window.size() * lanes, 0);
            std::vector<Vec3f> dense(chunk.uniform ? 0 : 8 * window.size() * lanes);
            for (std::size_t lane = 0; lane < chunk.groups.size(); ++lane) {
                block.lane_group[c * lanes + lane] = chunk.groups[lane];
                const auto entry_of = add_window(chunk, lane, window, begins[c].slot);
                if (!chunk.uniform) add_gradients(chunk.groups[lane], entry_of, window.size(), lanes, lane, dense);
            }
            if (!chunk.uniform)
                add_pairs(dense, window.size(), lanes, block.entry, block.gradient, packed.pair_begin, begins[c].entry);
            if (packed.law != Law::linear) block.moves = true;
            block.chunks.push_back(packed);
        }
        for (std::size_t c = 0; c < chunks.size(); ++c) {
            CellChunk& chunk = block.chunks[c];
            chunk.slot = block.slot.data() + begins[c].slot;
            if (chunk.uniform) {
                const Shape& shape = whole.shapes_[group(chunks[c].groups[0]).shape];
                chunk.pair_begin = shape.pair_begin;
                chunk.entry = shape.entry.data();
                chunk.gradient = shape.gradient.data();
            } else {
                chunk.entry = block.entry.data() + begins[c].entry;
                chunk.gradient = block.gradient.data() + begins[c].gradient;
            }
        }
    }
};

CellBlocks::CellBlocks(const Model& model, const Threads& threads, double tolerance, Instructions instructions)
    : groups_(group_cells(model, tolerance, threads)),
      lanes_(cell_lanes(instructions)),
      kernel_(cell_kernel(instructions)),
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

    // Shared gradients of the shapes that can fill a chunk.
    std::vector<std::uint32_t> leader(groups_.shapes, no_index);
    for (std::uint32_t g = 0; g < groups_.groups.size(); ++g) {
        std::uint32_t& l = leader[groups_.groups[g].shape];
        if (l == no_index && groups_.groups[g].sharing >= lanes_ - lanes_ / 4) l = g;
    }
    shapes_.resize(groups_.shapes);
    threads.for_each(shapes_.size(), 16, [&](std::size_t s) {
        if (leader[s] == no_index) return;
        const CellGroups::Group& g = groups_.groups[leader[s]];
        const std::size_t entries = groups_.window_size(g);
        std::vector<Vec3f> dense(8 * entries);
        std::vector<Vec3> spread(entries);
        for (std::size_t octant = 0; octant < 8; ++octant) {
            if (g.point[octant] == no_index) continue;
            groups_.spread_gradients(model, g, octant, spread);
            for (std::size_t e = 0; e < entries; ++e) dense[octant * entries + e] = vector_cast<float>(spread[e]);
        }
        BlockBuilder::add_pairs(dense, entries, 1, shapes_[s].entry, shapes_[s].gradient, shapes_[s].pair_begin, 0);
    });

    blocks_.resize(begin.size() - 1);
    std::vector<std::vector<std::uint32_t>> slot_nodes(blocks_.size());
    std::vector<char> complete(blocks_.size());
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        BlockBuilder builder{*this,      model,         std::span(order).subspan(begin[b], begin[b + 1] - begin[b]),
                             blocks_[b], slot_nodes[b], {}};
        builder.run();
        complete[b] = builder.complete;
    });
    matches_model_ = std::find(complete.begin(), complete.end(), 0) == complete.end();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        blocks_[b].slot_begin = static_cast<std::uint32_t>(slot_node_.size());
        slot_node_.insert(slot_node_.end(), slot_nodes[b].begin(), slot_nodes[b].end());
        blocks_[b].slot_end = static_cast<std::uint32_t>(slot_node_.size());
    }
    transpose_slots(model.rest.size());
    u_.resize(slot_node_.size());
    f_.resize(slot_node_.size());
    set_materials(model, threads);

    counts_.groups = groups_.groups.size();
    for (std::uint32_t q = 0; q < model.stencils.points(); ++q)
        counts_.pairs += model.stencils.offset[q + 1] - model.stencils.offset[q];
    for (const Block& block : blocks_) {
        counts_.chunks += block.chunks.size();
        for (const CellChunk& chunk : block.chunks) {
            counts_.uniform_chunks += chunk.uniform;
            counts_.lane_pairs += chunk.pair_begin[8] * lanes_;
            largest_window_ = std::max<std::size_t>(largest_window_, chunk.entries);
        }
        counts_.bytes += 4 * block.gradient.size() + 2 * block.entry.size() + 2 * block.slot.size();
    }
    for (const Shape& shape : shapes_) counts_.bytes += 4 * shape.gradient.size() + 2 * shape.entry.size();
}

void CellBlocks::transpose_slots(std::size_t nodes) {
    node_slot_offset_.assign(nodes + 1, 0);
    for (std::uint32_t n : slot_node_)
        if (n != no_index) ++node_slot_offset_[n + 1];
    for (std::size_t n = 0; n < nodes; ++n) node_slot_offset_[n + 1] += node_slot_offset_[n];
    node_slots_.resize(node_slot_offset_[nodes]);
    std::vector<std::uint32_t> next(node_slot_offset_.begin(), node_slot_offset_.end() - 1);
    for (std::uint32_t slot = 0; slot < slot_node_.size(); ++slot)
        if (slot_node_[slot] != no_index) node_slots_[next[slot_node_[slot]]++] = slot;
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
        Block& block = blocks_[b];
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
void CellBlocks::join_lanes(Block& block, std::size_t chunk) const {
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

void CellBlocks::fill_moduli(const Model& model, const CellGroups::Group& group, Block& block, std::size_t chunk,
                             std::size_t lane) const {
    const bool shared = group.dilatation_cell != no_index;
    if (shared) block.chunks[chunk].share = &block.share[chunk * 8 * lanes_];
    for (std::size_t octant = 0; octant < 8; ++octant) {
        const std::uint32_t q = group.point[octant];
        if (q == no_index) continue;
        const MaterialPoint& point = model.point_material(q);
        const double lambda = shared ? model.dilatation.lambda[group.dilatation_cell] : point.lame.lambda;
        const double V = model.volumes[q] / stiffness_;
        const std::size_t at = (chunk * 8 + octant) * lanes_;
        block.lame[2 * at + lane] = static_cast<float>(V * lambda);
        block.lame[2 * at + lanes_ + lane] = static_cast<float>(V * point.lame.mu);
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

Mat3 CellBlocks::move_to_slots(const Model& m, const Block& block, std::span<const Vec3> x, Float4* u) const {
    const std::span nodes = std::span(slot_node_).subspan(block.slot_begin + 1, block.slot_end - block.slot_begin - 1);
    const Mat3 R = block.moves ? frame_of(m, nodes, x) : Mat3::identity();
    const Mat3 Rt = (1 / length_) * transpose(R);
    const Vec3 x0 = x[nodes[0]], X0 = m.rest[nodes[0]];
    u[0] = Float4{};
    for (std::size_t s = 0; s < nodes.size(); ++s) {
        const Vec3 d = Rt * (x[nodes[s]] - x0) - (1 / length_) * (m.rest[nodes[s]] - X0);
        u[s + 1] = {{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), 0}};
    }
    return R;
}

double CellBlocks::run(const Block& block, CellTask task) const {
    thread_local std::vector<float> scratch;
    scratch.resize(std::max(scratch.size(), 6 * largest_window_ * lanes_));
    Float4* f = &f_[block.slot_begin];
    if (task != CellTask::energy) std::fill(f, f + (block.slot_end - block.slot_begin), Float4{});
    return kernel_(block.chunks, task, &u_[block.slot_begin], f, scratch.data());
}

void CellBlocks::forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) const {
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        const Block& block = blocks_[b];
        const Mat3 R = move_to_slots(m, block, x, &u_[block.slot_begin]);
        run(block, CellTask::forces);
        if (!block.moves) return;
        Mat3f turn;
        for (std::size_t r = 0; r < 3; ++r) turn.rows[r] = vector_cast<float>(R.rows[r]);
        for (std::uint32_t s = block.slot_begin; s < block.slot_end; ++s) {
            const Vec3f v = turn * Vec3f{f_[s].lane[0], f_[s].lane[1], f_[s].lane[2]};
            f_[s] = {{v.x, v.y, v.z, 0}};
        }
    });
    const double unit = stiffness_ / length_;
    threads.for_each(f.size(), node_chunk, [&](std::size_t i) {
        Vec3 sum{};
        for (std::uint32_t k = node_slot_offset_[i]; k < node_slot_offset_[i + 1]; ++k) {
            const Float4& v = f_[node_slots_[k]];
            sum += Vec3{double(v.lane[0]), double(v.lane[1]), double(v.lane[2])};
        }
        f[i] = unit * sum;
    });
}

double CellBlocks::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) const {
    return stiffness_ * threads.sum(blocks_.size(), 1, [&](std::size_t b) {
        move_to_slots(m, blocks_[b], x, &u_[blocks_[b].slot_begin]);
        return run(blocks_[b], CellTask::energy);
    });
}

void CellBlocks::rest_action(const Model&, std::span<const Vec3f> d, const Threads& threads,
                             std::span<Vec3f> out) const {
    threads.for_each(blocks_.size(), 1, [&](std::size_t b) {
        const Block& block = blocks_[b];
        Float4* u = &u_[block.slot_begin];
        const std::uint32_t* node = &slot_node_[block.slot_begin];
        const Vec3f origin = d[node[1]];
        u[0] = Float4{};
        for (std::uint32_t s = 1; s < block.slot_end - block.slot_begin; ++s) {
            const Vec3f v = d[node[s]] - origin;
            u[s] = {{v.x, v.y, v.z, 0}};
        }
        run(block, CellTask::rest_action);
    });
    const auto unit = static_cast<float>(stiffness_ / (length_ * length_));
    threads.for_each(out.size(), node_chunk, [&](std::size_t i) {
        Vec3f sum{};
        for (std::uint32_t k = node_slot_offset_[i]; k < node_slot_offset_[i + 1]; ++k) {
            const Float4& v = f_[node_slots_[k]];
            sum += Vec3f{v.lane[0], v.lane[1], v.lane[2]};
        }
        out[i] = unit * sum;
    });
}

}  // namespace phyxel
