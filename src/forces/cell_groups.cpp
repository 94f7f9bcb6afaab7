#include "forces/cell_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>

namespace phyxel {
namespace {

using Index3 = CellGroups::Index3;
using Place = CellGroups::Place;

/// Edge of a group's cell in pitches, and where cells begin. Points at nodes lie on the lattice itself: a quarter of
/// a pitch beside the faces keeps them from falling to either side by rounding.
struct CellFrame {
    double edge, shift;
    bool by_octant;  ///< eight points a cell, one in each octant
};

CellFrame cell_frame(const Sampling& s) {
    const bool grid = s.quadrature == Quadrature::grid;
    return {grid ? s.pitch : 2 * s.spacing, grid ? 0 : -0.25 * s.pitch, grid && s.lattice == Lattice::cubic};
}

/// A point with what it is sorted by.
struct SortedPoint {
    Index3 cell{};
    Law law{};
    std::uint32_t dilatation_cell = no_index;
    Index3 place{};
    std::uint32_t q = 0;
    auto operator<=>(const SortedPoint&) const = default;
};

SortedPoint sorted_point(const Model& m, const CellFrame& frame, std::uint32_t q) {
    SortedPoint p{.law = m.point_material(q).law, .q = q};
    if (!m.dilatation.empty()) p.dilatation_cell = m.dilatation.cell[q];
    for (std::size_t c = 0; c < 3; ++c) {
        const double t = (m.sampling.points[q][c] - frame.shift) / frame.edge;
        p.cell[c] = static_cast<std::int32_t>(std::floor(t));
        p.place[c] = static_cast<std::int32_t>(std::floor((t - p.cell[c]) * (frame.by_octant ? 2 : 8)));
    }
    return p;
}

class Builder {
public:
    Builder(const Model& model, double tolerance, bool families, const Threads& threads)
        : m_(model),
          st_(model.stencils),
          frame_(cell_frame(model.sampling)),
          tolerance_(tolerance),
          families_(families),
          threads_(threads) {}

    CellGroups run() {
        locate_points();
        deal_points();
        collect_windows();
        find_shapes();
        return std::move(result_);
    }

private:
    void locate_points() {
        result_.point_slot_begin.resize(st_.points());
        for (const auto& block : st_.blocks)
            for (std::uint32_t q = block.point_begin; q < block.point_end; ++q)
                result_.point_slot_begin[q] = block.slot_begin;
    }

    std::uint32_t pair_node(std::uint32_t q, std::uint32_t k) const {
        return st_.slot_node[result_.point_slot_begin[q] + st_.local[k]];
    }

    bool sees(std::uint32_t q, std::uint32_t node) const {
        for (std::uint32_t k = st_.offset[q]; k < st_.offset[q + 1]; ++k)
            if (pair_node(q, k) == node) return true;
        return false;
    }

    /// Whether a point of the group sees the first node that `q` sees: parts on two sides of a gap share none.
    bool connected(const CellGroups::Group& group, std::uint32_t q) const {
        if (m_.sampling.split_boxes == 0 || st_.offset[q] == st_.offset[q + 1]) return true;
        const std::uint32_t node = pair_node(q, st_.offset[q]);
        return std::any_of(group.point.begin(), group.point.end(),
                           [&](std::uint32_t other) { return other != no_index && sees(other, node); });
    }

    /// Octant of a point that the group has free; 8 when there is none.
    std::size_t free_octant(const CellGroups::Group& group, const SortedPoint& p) const {
        if (frame_.by_octant) {
            const auto octant = static_cast<std::size_t>(p.place[0] * 4 + p.place[1] * 2 + p.place[2]);
            return group.point[octant] == no_index ? octant : 8;
        }
        return static_cast<std::size_t>(std::find(group.point.begin(), group.point.end(), no_index) -
                                        group.point.begin());
    }

    void deal_points() {
        std::vector<SortedPoint> points(st_.points());
        threads_.for_each(points.size(), 1024,
                          [&](std::size_t q) { points[q] = sorted_point(m_, frame_, static_cast<std::uint32_t>(q)); });
        std::sort(points.begin(), points.end());
        auto& groups = result_.groups;
        std::size_t first = 0;  // group of the cell at work
        for (const SortedPoint& p : points) {
            const auto begins = [&](const CellGroups::Group& last) {
                return last.cell != p.cell || last.law != p.law || last.dilatation_cell != p.dilatation_cell;
            };
            if (groups.empty() || begins(groups.back())) first = groups.size();
            std::size_t g = first;
            while (g < groups.size() && (free_octant(groups[g], p) == 8 || !connected(groups[g], p.q))) ++g;
            if (g == groups.size()) {
                groups.push_back({.cell = p.cell, .point = {}, .law = p.law, .dilatation_cell = p.dilatation_cell});
                groups.back().point.fill(no_index);
            }
            groups[g].point[free_octant(groups[g], p)] = p.q;
        }
        join_groups();
    }

    /// Marks groups whose dilatation cell has several, and puts all of these in the cell of the first.
    void join_groups() {
        std::vector<std::uint32_t> first(m_.dilatation.volume.size(), no_index);
        auto& groups = result_.groups;
        for (std::uint32_t g = 0; g < groups.size(); ++g) {
            if (groups[g].dilatation_cell == no_index) continue;
            std::uint32_t& leader = first[groups[g].dilatation_cell];
            if (leader == no_index) {
                leader = g;
                continue;
            }
            groups[leader].joined = groups[g].joined = true;
            groups[g].cell = groups[leader].cell;
        }
    }

    Place place(const Index3& cell, std::uint32_t node) const {
        Place result{};
        for (std::size_t c = 0; c < 3; ++c)
            result[c] = static_cast<std::int16_t>(
                std::lround(4 * ((m_.sampling.nodes[node][c] - frame_.shift) / m_.sampling.pitch -
                                 cell[c] * (frame_.edge / m_.sampling.pitch))));
        return result;
    }

    std::vector<std::pair<Place, std::uint32_t>> window(const CellGroups::Group& group) const {
        std::vector<std::uint32_t> nodes;
        for (std::uint32_t q : group.point)
            if (q != no_index)
                for (std::uint32_t k = st_.offset[q]; k < st_.offset[q + 1]; ++k) nodes.push_back(pair_node(q, k));
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        std::vector<std::pair<Place, std::uint32_t>> entries;
        for (std::uint32_t node : nodes) entries.push_back({place(group.cell, node), node});
        std::sort(entries.begin(), entries.end());
        for (std::size_t e = 1; e < entries.size(); ++e) {  // several nodes in one box: first, second, ...
            Place before = entries[e - 1].first;
            before[3] = 0;
            if (before == entries[e].first)
                entries[e].first[3] = static_cast<std::int16_t>(entries[e - 1].first[3] + 1);
        }
        return entries;
    }

    void collect_windows() {
        constexpr std::size_t batch = 4096;
        std::vector<std::vector<std::pair<Place, std::uint32_t>>> windows;
        for (std::size_t begin = 0; begin < result_.groups.size(); begin += batch) {
            windows.assign(std::min(batch, result_.groups.size() - begin), {});
            threads_.for_each(windows.size(), 64,
                              [&](std::size_t g) { windows[g] = window(result_.groups[begin + g]); });
            for (std::size_t g = 0; g < windows.size(); ++g) {
                CellGroups::Group& group = result_.groups[begin + g];
                group.window_begin = static_cast<std::uint32_t>(result_.node.size());
                for (const auto& [place, node] : windows[g]) {
                    result_.place.push_back(place);
                    result_.node.push_back(node);
                }
                group.window_end = static_cast<std::uint32_t>(result_.node.size());
            }
        }
    }

    /// What groups of one shape have in common: a hash of their window and points, and random projections of their
    /// gradients.
    struct Signature {
        std::uint64_t window = 0;
        std::array<double, 4> gradients{};
        std::uint32_t group = 0;

        /// Largest difference of the projections.
        double distance(const Signature& other) const {
            double largest = 0;
            for (std::size_t k = 0; k < gradients.size(); ++k)
                largest = std::max(largest, std::abs(gradients[k] - other.gradients[k]));
            return largest;
        }
    };

    Signature signature(std::uint32_t g, std::span<const Vec3> random, std::vector<Vec3>& spread) const {
        const CellGroups::Group& group = result_.groups[g];
        Signature s{.group = g};
        const auto mix = [&](std::uint64_t value) {
            s.window = (s.window ^ value) * 0x9E3779B97F4A7C15u + (s.window >> 29);
        };
        mix(group.kind() + 1);
        for (std::uint32_t e = group.window_begin; e < group.window_end; ++e)
            for (const std::int16_t c : result_.place[e]) mix(static_cast<std::uint16_t>(c));
        spread.resize(result_.window_size(group));
        for (std::size_t octant = 0; octant < 8; ++octant) {
            mix(group.point[octant] != no_index);
            if (group.point[octant] == no_index) continue;
            result_.spread_gradients(m_, group, octant, spread);
            for (std::size_t k = 0; k < s.gradients.size(); ++k)
                for (std::size_t e = 0; e < spread.size(); ++e)
                    s.gradients[k] += dot(spread[e], random[(1021 * k + 331 * octant + e) % random.size()]);
        }
        return s;
    }

    /// Whether two groups have equal windows and points, and gradients that differ by no more than `tolerance`.
    bool similar(std::uint32_t leader, std::uint32_t other, double tolerance) const {
        const CellGroups::Group &a = result_.groups[leader], &b = result_.groups[other];
        if (a.kind() != b.kind() || result_.window_size(a) != result_.window_size(b)) return false;
        for (std::uint32_t e = 0; e < result_.window_size(a); ++e)
            if (result_.place[a.window_begin + e] != result_.place[b.window_begin + e]) return false;
        std::vector<Vec3> spread_a(result_.window_size(a)), spread_b(result_.window_size(b));
        for (std::size_t octant = 0; octant < 8; ++octant) {
            const std::uint32_t qa = a.point[octant], qb = b.point[octant];
            if ((qa == no_index) != (qb == no_index)) return false;
            if (qa == no_index || st_.gradient_begin[qa] == st_.gradient_begin[qb]) continue;
            result_.spread_gradients(m_, a, octant, spread_a);
            result_.spread_gradients(m_, b, octant, spread_b);
            for (std::size_t e = 0; e < spread_a.size(); ++e)
                if (!(norm(spread_a[e] - spread_b[e]) <= tolerance)) return false;
        }
        return true;
    }

    std::vector<Signature> signatures() const {
        std::mt19937 engine(1);
        std::vector<Vec3> random(4096);
        for (Vec3& v : random)
            for (std::size_t c = 0; c < 3; ++c) v[c] = static_cast<double>(engine()) / 2147483648.0 - 1;
        std::vector<Signature> result(result_.groups.size());
        threads_.for_chunks(result.size(), 64, [&](std::size_t begin, std::size_t end) {
            std::vector<Vec3> spread;
            for (std::size_t g = begin; g < end; ++g)
                result[g] = signature(static_cast<std::uint32_t>(g), random, spread);
        });
        std::sort(result.begin(), result.end(), [](const Signature& a, const Signature& b) {
            return std::tie(a.window, a.gradients, a.group) < std::tie(b.window, b.gradients, b.group);
        });
        return result;
    }

    /// Groups take the number of a leader whose gradients are within `tolerance` of their own; returns the leaders.
    std::vector<std::uint32_t> follow_leaders(std::span<const Signature> sorted, double tolerance,
                                              std::uint32_t CellGroups::Group::*number) {
        // The projections are near too; random signs make a sum of a thousand differences some twenty times the
        // largest.
        constexpr std::size_t most_leaders = 256;
        const double near = 30 * tolerance;
        std::vector<const Signature*> leaders;
        for (const Signature& s : sorted) {
            std::size_t found = leaders.size();
            for (std::size_t back = 1; back <= std::min(most_leaders, leaders.size()); ++back) {
                const Signature& leader = *leaders[leaders.size() - back];
                if (leader.window != s.window || s.gradients[0] - leader.gradients[0] > near) break;
                if (s.distance(leader) > near || !similar(leader.group, s.group, tolerance)) continue;
                found = leaders.size() - back;
                break;
            }
            if (found == leaders.size()) leaders.push_back(&s);
            result_.groups[s.group].*number = static_cast<std::uint32_t>(found);
        }
        std::vector<std::uint32_t> groups;
        for (const Signature* leader : leaders) groups.push_back(leader->group);
        return groups;
    }

    void find_shapes() {
        const std::vector<Signature> sorted = signatures();
        result_.shape_leader = follow_leaders(sorted, tolerance_, &CellGroups::Group::shape);
        if (families_) result_.family_leader = follow_leaders(sorted, similar_gradients, &CellGroups::Group::family);
    }

    const Model& m_;
    const Stencils& st_;
    CellFrame frame_;
    double tolerance_;
    bool families_;
    const Threads& threads_;
    CellGroups result_;
};

}  // namespace

void CellGroups::spread_gradients(const Model& m, const Group& group, std::size_t octant,
                                  std::span<Vec3> gradients) const {
    const Stencils& st = m.stencils;
    const std::uint32_t q = group.point[octant], size = group.window_end - group.window_begin;
    std::fill(gradients.begin(), gradients.end(), Vec3{});
    // Both lists are nearly in the same order: look on from the last one found.
    std::uint32_t e = 0;
    for (std::uint32_t k = st.offset[q], g = st.gradient_begin[q]; k < st.offset[q + 1]; ++k, ++g) {
        const std::uint32_t wanted = st.slot_node[point_slot_begin[q] + st.local[k]];
        while (node[group.window_begin + e] != wanted) e = e + 1 < size ? e + 1 : 0;
        gradients[e] = m.sampling.spacing * st.gradient[g];
    }
}

void CellGroups::spread_mean_gradients(const Model& m, const Group& group, std::span<Vec3> gradients) const {
    std::vector<Vec3> sum(gradients.size());
    double volume = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) {
        if (group.point[octant] == no_index) continue;
        const double V = m.volumes[group.point[octant]];
        spread_gradients(m, group, octant, gradients);
        for (std::size_t e = 0; e < sum.size(); ++e) sum[e] += V * gradients[e];
        volume += V;
    }
    for (std::size_t e = 0; e < sum.size(); ++e) gradients[e] = volume > 0 ? sum[e] / volume : Vec3{};
}

CellGroups group_cells(const Model& model, double tolerance, bool families, const Threads& threads) {
    return Builder(model, tolerance, families, threads).run();
}

}  // namespace phyxel
