#include "forces/cell_packing.h"

#include <algorithm>
#include <tuple>

namespace phyxel {
namespace {

/// Appends the pairs of a chunk, point by point: entries that any lane sees, with the gradients of `lanes` lanes.
void add_pairs(const std::vector<Vec3f>& dense, std::size_t entries, std::size_t lanes,
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

/// Calls `done(point)` with the gradients of each point of a group in `spread`.
template <class Done>
void for_points(const Model& model, const CellGroups& groups, const CellGroups::Group& group, CellPoints points,
                std::span<Vec3> spread, Done&& done) {
    if (points == CellPoints::mean) {
        groups.spread_mean_gradients(model, group, spread);
        return done(0);
    }
    for (std::size_t octant = 0; octant < 8; ++octant) {
        if (group.point[octant] == no_index) continue;
        groups.spread_gradients(model, group, octant, spread);
        done(octant);
    }
}

/// Deals the groups of one block to lanes and lays out what the kernel reads.
class BlockPacker {
public:
    BlockPacker(const Model& model, const CellGroups& groups, std::span<const CellShape> shapes,
                std::span<const std::uint32_t> members, std::size_t lanes, CellPoints points, CellBlock& block)
        : m_(model),
          groups_(groups),
          shapes_(shapes),
          members_(members),
          lanes_(lanes),
          points_(points),
          block_(block) {}

    void run() {
        deal();
        collect_slots();
        struct Begin {
            std::size_t slot, entry, gradient;
        };
        std::vector<Begin> begins;
        block_.lane_group.assign(chunks_.size() * lanes_, no_index);
        for (std::size_t c = 0; c < chunks_.size(); ++c) {
            const Lanes& chunk = chunks_[c];
            CellChunk packed{};
            packed.uniform = chunk.uniform;
            packed.law = group(chunk.groups[0]).law;
            const std::vector<CellGroups::Place> window = joint_window(chunk);
            packed.entries = static_cast<std::uint32_t>(window.size());
            begins.push_back({block_.slot.size(), block_.entry.size(), block_.gradient.size()});
            block_.slot.resize(block_.slot.size() + window.size() * lanes_, 0);
            std::vector<Vec3f> dense(chunk.uniform ? 0 : 8 * window.size() * lanes_);
            for (std::size_t lane = 0; lane < chunk.groups.size(); ++lane) {
                block_.lane_group[c * lanes_ + lane] = chunk.groups[lane];
                const auto entry_of = add_window(chunk, lane, window, begins[c].slot);
                if (!chunk.uniform) add_gradients(chunk.groups[lane], entry_of, window.size(), lane, dense);
            }
            if (!chunk.uniform)
                add_pairs(dense, window.size(), lanes_, block_.entry, block_.gradient, packed.pair_begin,
                          begins[c].entry);
            if (packed.law == Law::linear) block_.moves = false;
            block_.chunks.push_back(packed);
        }
        block_.gradient.shrink_to_fit();
        for (std::size_t c = 0; c < chunks_.size(); ++c) {
            CellChunk& chunk = block_.chunks[c];
            chunk.slot = block_.slot.data() + begins[c].slot;
            if (chunk.uniform) {
                const CellShape& shape = shapes_[group(chunks_[c].groups[0]).shape];
                chunk.pair_begin = shape.pair_begin;
                chunk.entry = shape.entry.data();
                chunk.gradient = shape.gradient.data();
            } else {
                chunk.entry = block_.entry.data() + begins[c].entry;
                chunk.gradient = block_.gradient.data() + begins[c].gradient;
            }
        }
    }

private:
    /// Chunks of groups: `uniform` ones first.
    struct Lanes {
        std::vector<std::uint32_t> groups;
        bool uniform;
    };
    const CellGroups::Group& group(std::uint32_t g) const { return groups_.groups[g]; }

    void deal() {
        std::vector<std::uint32_t> rest;
        for (std::size_t begin = 0, end; begin < members_.size(); begin = end) {
            end = begin + 1;
            while (end < members_.size() && group(members_[end]).shape == group(members_[begin]).shape) ++end;
            const std::size_t least = group(members_[begin]).joined ? members_.size() + 1 : lanes_ - lanes_ / 4;
            for (; end - begin >= least; begin += std::min(lanes_, end - begin)) {
                const auto first = members_.begin() + static_cast<std::ptrdiff_t>(begin);
                chunks_.push_back({{first, first + static_cast<std::ptrdiff_t>(std::min(lanes_, end - begin))}, true});
            }
            rest.insert(rest.end(), members_.begin() + static_cast<std::ptrdiff_t>(begin),
                        members_.begin() + static_cast<std::ptrdiff_t>(end));
        }
        // Windows of one size lie together, so that few lanes wait for entries that others have; parts of one
        // dilatation cell in one chunk.
        std::stable_sort(rest.begin(), rest.end(), [&](std::uint32_t a, std::uint32_t b) {
            const auto key = [&](std::uint32_t g) {
                const CellGroups::Group& of = group(g);
                return std::tuple(of.kind(), of.joined ? of.dilatation_cell : 0, groups_.window_size(of), of.cell);
            };
            return key(a) < key(b);
        });
        for (std::size_t begin = 0, end; begin < rest.size(); begin = end) {
            const CellGroups::Group& first = group(rest[begin]);
            end = begin + 1;
            while (first.joined && end < rest.size() && group(rest[end]).dilatation_cell == first.dilatation_cell)
                ++end;
            const bool fits = !chunks_.empty() && !chunks_.back().uniform &&
                              group(chunks_.back().groups[0]).kind() == first.kind() &&
                              chunks_.back().groups.size() + (end - begin) <= lanes_;
            if (!fits) chunks_.push_back({{}, false});
            for (std::size_t i = begin; i < end; ++i) {
                if (chunks_.back().groups.size() == lanes_) chunks_.push_back({{}, false}), block_.complete = false;
                chunks_.back().groups.push_back(rest[i]);
            }
        }
    }

    void collect_slots() {
        for (std::uint32_t g : members_)
            block_.slot_node.insert(block_.slot_node.end(), groups_.node.begin() + group(g).window_begin,
                                    groups_.node.begin() + group(g).window_end);
        std::sort(block_.slot_node.begin(), block_.slot_node.end());
        block_.slot_node.erase(std::unique(block_.slot_node.begin(), block_.slot_node.end()), block_.slot_node.end());
        block_.slot_node.insert(block_.slot_node.begin(), no_index);
    }

    std::uint16_t slot_of(std::uint32_t node) const {
        return static_cast<std::uint16_t>(std::lower_bound(block_.slot_node.begin() + 1, block_.slot_node.end(), node) -
                                          block_.slot_node.begin());
    }

    /// The places of all windows of a chunk, each once.
    std::vector<CellGroups::Place> joint_window(const Lanes& chunk) const {
        std::vector<CellGroups::Place> window;
        for (std::uint32_t g : chunk.groups)
            window.insert(window.end(), groups_.place.begin() + group(g).window_begin,
                          groups_.place.begin() + group(g).window_end);
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
            while (window[e] != groups_.place[own]) ++e;
            entry_of.push_back(static_cast<std::uint32_t>(e));
            block_.slot[slot_begin + e * lanes_ + lane] = slot_of(groups_.node[own]);
        }
        return entry_of;
    }

    void add_gradients(std::uint32_t g, const std::vector<std::uint32_t>& entry_of, std::size_t entries,
                       std::size_t lane, std::vector<Vec3f>& dense) const {
        std::vector<Vec3> spread(entry_of.size());
        for_points(m_, groups_, group(g), points_, spread, [&](std::size_t point) {
            for (std::size_t e = 0; e < spread.size(); ++e)
                dense[(point * entries + entry_of[e]) * lanes_ + lane] = vector_cast<float>(spread[e]);
        });
    }

    const Model& m_;
    const CellGroups& groups_;
    std::span<const CellShape> shapes_;
    std::span<const std::uint32_t> members_;
    std::size_t lanes_;
    CellPoints points_;
    CellBlock& block_;
    std::vector<Lanes> chunks_;
};

}  // namespace

CellShape pack_shape(const Model& model, const CellGroups& groups, const CellGroups::Group& group, CellPoints points) {
    CellShape shape;
    const std::size_t entries = groups.window_size(group);
    std::vector<Vec3f> dense(8 * entries);
    std::vector<Vec3> spread(entries);
    for_points(model, groups, group, points, spread, [&](std::size_t point) {
        for (std::size_t e = 0; e < entries; ++e) dense[point * entries + e] = vector_cast<float>(spread[e]);
    });
    add_pairs(dense, entries, 1, shape.entry, shape.gradient, shape.pair_begin, 0);
    return shape;
}

CellBlock pack_block(const Model& model, const CellGroups& groups, std::span<const CellShape> shapes,
                     std::span<const std::uint32_t> members, std::size_t lanes, CellPoints points) {
    CellBlock block;
    BlockPacker(model, groups, shapes, members, lanes, points, block).run();
    return block;
}

}  // namespace phyxel
