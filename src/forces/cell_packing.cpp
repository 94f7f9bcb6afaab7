#include "forces/cell_packing.h"

#include <algorithm>
#include <cmath>
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

static_assert(similar_gradients / double{gradient_unit(ChunkKind::similar)} < 32767);

/// So many groups are worth a chunk of their own.
std::size_t least_sharing(std::size_t lanes) { return lanes - lanes / 4; }

/// Deals the groups of one block to lanes and lays out what the kernel reads.
class BlockPacker {
public:
    BlockPacker(const Model& model, const CellGroups& groups, const CellShapes& shapes,
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
        block_.lane_group.assign(chunks_.size() * lanes_, no_index);
        std::vector<Begin> begins;
        for (std::size_t c = 0; c < chunks_.size(); ++c) {
            begins.push_back(
                {block_.slot.size(), block_.entry.size(), block_.gradient.size(), block_.difference.size()});
            pack(c, begins.back());
        }
        block_.gradient.shrink_to_fit();
        block_.difference.shrink_to_fit();
        for (std::size_t c = 0; c < chunks_.size(); ++c) point_into_block(block_.chunks[c], chunks_[c], begins[c]);
    }

private:
    /// Groups of a chunk.
    struct Lanes {
        std::vector<std::uint32_t> groups;
        ChunkKind kind;
    };
    /// Where a chunk's parts begin in the block's vectors.
    struct Begin {
        std::size_t slot, entry, gradient, difference;
    };
    const CellGroups::Group& group(std::uint32_t g) const { return groups_.groups[g]; }

    /// What the chunk's lanes share; nothing for mixed chunks.
    const CellShape* shape_of(const Lanes& chunk) const {
        const CellGroups::Group& first = group(chunk.groups[0]);
        if (chunk.kind == ChunkKind::mixed) return nullptr;
        return chunk.kind == ChunkKind::uniform ? &shapes_.exact[first.shape] : &shapes_.similar[first.family];
    }

    void pack(std::size_t c, const Begin& begin) {
        Lanes& chunk = chunks_[c];
        CellChunk packed{};
        packed.law = group(chunk.groups[0]).law;
        const std::vector<CellGroups::Place> window = joint_window(chunk);
        packed.entries = static_cast<std::uint32_t>(window.size());
        block_.slot.resize(block_.slot.size() + window.size() * lanes_, 0);
        std::vector<Vec3f> dense(chunk.kind == ChunkKind::uniform ? 0 : 8 * window.size() * lanes_);
        for (std::size_t lane = 0; lane < chunk.groups.size(); ++lane) {
            block_.lane_group[c * lanes_ + lane] = chunk.groups[lane];
            const auto entry_of = add_window(chunk, lane, window, begin.slot);
            if (!dense.empty()) add_gradients(chunk.groups[lane], entry_of, window.size(), lane, dense);
        }
        if (chunk.kind == ChunkKind::similar &&
            !add_differences(*shape_of(chunk), chunk.groups.size(), dense, window.size()))
            chunk.kind = ChunkKind::mixed;
        packed.kind = chunk.kind;
        if (chunk.kind == ChunkKind::mixed)
            add_pairs(dense, window.size(), lanes_, block_.entry, block_.gradient, packed.pair_begin, begin.entry);
        if (packed.law == Law::linear) block_.moves = false;
        block_.chunks.push_back(packed);
    }

    void point_into_block(CellChunk& packed, const Lanes& chunk, const Begin& begin) const {
        packed.slot = block_.slot.data() + begin.slot;
        if (const CellShape* shape = shape_of(chunk)) {
            packed.pair_begin = shape->pair_begin;
            packed.entry = shape->entry.data();
            packed.gradient = shape->gradient.data();
            if (chunk.kind == ChunkKind::similar) packed.difference = block_.difference.data() + begin.difference;
        } else {
            packed.entry = block_.entry.data() + begin.entry;
            packed.gradient = block_.gradient.data() + begin.gradient;
        }
    }

    /// What the gradients of the lanes differ from the shared ones by; false, and nothing done, where a lane sees a
    /// node that these leave out.
    bool add_differences(const CellShape& shape, std::size_t filled, const std::vector<Vec3f>& dense,
                         std::size_t entries) {
        std::vector<std::int16_t> differences(shape.gradient.size() * lanes_);
        std::size_t seen = 0;
        const auto is_seen = [](const Vec3f& g) { return !(g == Vec3f{}); };
        for (std::size_t point = 0; point < 8; ++point)
            for (std::uint32_t p = shape.pair_begin[point]; p < shape.pair_begin[point + 1]; ++p) {
                const Vec3f* g = &dense[(point * entries + shape.entry[p]) * lanes_];
                seen += static_cast<std::size_t>(std::count_if(g, g + lanes_, is_seen));
                for (std::size_t c = 3 * p; c < 3 * p + 3; ++c)
                    for (std::size_t lane = 0; lane < filled; ++lane)
                        differences[c * lanes_ + lane] = static_cast<std::int16_t>(
                            std::lround(g[lane][c - 3 * p] / gradient_unit(ChunkKind::similar) - shape.gradient[c]));
            }
        if (seen != static_cast<std::size_t>(std::count_if(dense.begin(), dense.end(), is_seen))) return false;
        block_.difference.insert(block_.difference.end(), differences.begin(), differences.end());
        return true;
    }

    /// Takes chunks of groups that agree in `number` out of `members`; returns what is left.
    std::vector<std::uint32_t> deal_alike(std::span<const std::uint32_t> members,
                                          std::uint32_t CellGroups::Group::*number, ChunkKind kind) {
        std::vector<std::uint32_t> rest;
        for (std::size_t begin = 0, end; begin < members.size(); begin = end) {
            const CellGroups::Group& first = group(members[begin]);
            end = begin + 1;
            while (end < members.size() && group(members[end]).*number == first.*number) ++end;
            for (; !first.joined && end - begin >= least_sharing(lanes_); begin += std::min(lanes_, end - begin)) {
                const auto alike = members.subspan(begin, std::min(lanes_, end - begin));
                chunks_.push_back({{alike.begin(), alike.end()}, kind});
            }
            rest.insert(rest.end(), members.begin() + static_cast<std::ptrdiff_t>(begin),
                        members.begin() + static_cast<std::ptrdiff_t>(end));
        }
        return rest;
    }

    void deal() {
        std::vector<std::uint32_t> rest = deal_alike(members_, &CellGroups::Group::shape, ChunkKind::uniform);
        if (!shapes_.similar.empty()) {
            std::stable_sort(rest.begin(), rest.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return group(a).family < group(b).family; });
            rest = deal_alike(rest, &CellGroups::Group::family, ChunkKind::similar);
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
            const bool fits = !chunks_.empty() && chunks_.back().kind == ChunkKind::mixed &&
                              group(chunks_.back().groups[0]).kind() == first.kind() &&
                              chunks_.back().groups.size() + (end - begin) <= lanes_;
            if (!fits) chunks_.push_back({{}, ChunkKind::mixed});
            for (std::size_t i = begin; i < end; ++i) {
                if (chunks_.back().groups.size() == lanes_)
                    chunks_.push_back({{}, ChunkKind::mixed}), block_.complete = false;
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
    const CellShapes& shapes_;
    std::span<const std::uint32_t> members_;
    std::size_t lanes_;
    CellPoints points_;
    CellBlock& block_;
    std::vector<Lanes> chunks_;
};

CellShape pack_shape(const Model& model, const CellGroups& groups, const CellGroups::Group& group, CellPoints points,
                     float unit) {
    CellShape shape;
    const std::size_t entries = groups.window_size(group);
    std::vector<Vec3f> dense(8 * entries);
    std::vector<Vec3> spread(entries);
    for_points(model, groups, group, points, spread, [&](std::size_t point) {
        for (std::size_t e = 0; e < entries; ++e) dense[point * entries + e] = vector_cast<float>(spread[e]);
    });
    add_pairs(dense, entries, 1, shape.entry, shape.gradient, shape.pair_begin, 0);
    for (float& g : shape.gradient) g /= unit;
    return shape;
}

}  // namespace

CellShapes pack_shapes(const Model& model, const CellGroups& groups, std::size_t lanes, CellPoints points,
                       const Threads& threads) {
    const auto pack = [&](std::span<const std::uint32_t> leaders, std::uint32_t CellGroups::Group::*number,
                          ChunkKind kind) {
        std::vector<std::size_t> sharing(leaders.size());
        if (!leaders.empty())
            for (const CellGroups::Group& group : groups.groups) ++sharing[group.*number];
        std::vector<CellShape> shapes(leaders.size());
        threads.for_each(shapes.size(), 16, [&](std::size_t s) {
            if (sharing[s] >= least_sharing(lanes))
                shapes[s] = pack_shape(model, groups, groups.groups[leaders[s]], points, gradient_unit(kind));
        });
        return shapes;
    };
    return {pack(groups.shape_leader, &CellGroups::Group::shape, ChunkKind::uniform),
            pack(groups.family_leader, &CellGroups::Group::family, ChunkKind::similar)};
}

CellBlock pack_block(const Model& model, const CellGroups& groups, const CellShapes& shapes,
                     std::span<const std::uint32_t> members, std::size_t lanes, CellPoints points) {
    CellBlock block;
    BlockPacker(model, groups, shapes, members, lanes, points, block).run();
    return block;
}

}  // namespace phyxel
