#include "sampling/lattice_sites.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace phyxel {
namespace {

using Index3 = std::array<std::int32_t, 3>;

/// The two sites of a box that carry nodes, corner first.
std::array<Index3, 2> sites_of_box(const Index3& box) {
    std::array<Index3, 2> sites;
    for (int parity = 0; parity < 2; ++parity)
        for (int c = 0; c < 3; ++c) sites[parity][c] = (box[c] & 1) == parity ? box[c] : box[c] - 1;
    return sites;
}

struct SiteCell {
    Index3 site;
    std::uint32_t cell;
    int slot;
};

/// Groups of cells around one site that touch each other, directly or through one another.
std::vector<std::vector<SiteCell>> touching_groups(const Sampling& s, std::span<const SiteCell> around) {
    std::vector<std::size_t> group(around.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t a = 0; a < around.size(); ++a)
            for (std::size_t b = 0; b < around.size(); ++b) {
                const auto begin = s.neighbors.begin() + s.neighbor_offset[around[a].cell];
                const auto end = s.neighbors.begin() + s.neighbor_offset[around[a].cell + 1];
                if (group[a] < group[b] && std::find(begin, end, around[b].cell) != end)
                    group[b] = group[a], changed = true;
            }
    }
    std::vector<std::vector<SiteCell>> groups;
    for (std::size_t g = 0; g < around.size(); ++g) {
        std::vector<SiteCell> members;
        for (std::size_t a = 0; a < around.size(); ++a)
            if (group[a] == g) members.push_back(around[a]);
        if (!members.empty()) groups.push_back(std::move(members));
    }
    return groups;
}

}  // namespace

void place_cubic_nodes(Sampling& s, std::span<const double> cell_volume, double share) {
    const double whole = s.pitch * s.pitch * s.pitch;
    for (std::uint32_t c = 0; c < s.cell_box.size(); ++c) {
        s.cell_nodes.push_back({no_index, no_index});
        if (cell_volume[c] < share * whole) continue;
        s.cell_nodes[c][0] = static_cast<std::uint32_t>(s.nodes.size());
        s.nodes.push_back(s.cell_centers[c]);
        s.node_cell.push_back(c);
    }
}

void place_bcc_nodes(Sampling& s, std::span<const double> cell_volume, double share) {
    std::vector<SiteCell> at;
    for (std::uint32_t c = 0; c < s.cell_box.size(); ++c) {
        const auto sites = sites_of_box(s.cell_box[c]);
        at.push_back({sites[0], c, 0});
        at.push_back({sites[1], c, 1});
    }
    std::sort(at.begin(), at.end(), [](const SiteCell& a, const SiteCell& b) {
        return a.site != b.site ? a.site < b.site : a.cell < b.cell;
    });
    s.cell_nodes.assign(s.cell_box.size(), {no_index, no_index});
    const double whole = 4 * s.pitch * s.pitch * s.pitch;  // half of each of the eight boxes around a site
    for (std::size_t begin = 0, end; begin < at.size(); begin = end) {
        for (end = begin; end < at.size() && at[end].site == at[begin].site; ++end) {
        }
        for (const auto& group : touching_groups(s, std::span(at).subspan(begin, end - begin))) {
            double volume = 0;
            for (const SiteCell& member : group) volume += cell_volume[member.cell] / 2;
            if (volume < share * whole) continue;
            const Index3& site = group.front().site;
            for (const SiteCell& member : group)
                s.cell_nodes[member.cell][member.slot] = static_cast<std::uint32_t>(s.nodes.size());
            s.nodes.push_back(Vec3{site[0] + 0.5, site[1] + 0.5, site[2] + 0.5} * s.pitch);
            s.node_cell.push_back(group.front().cell);
        }
    }
}

std::size_t count_nodes(const ClippedVolume& clipped, Lattice lattice, double share) {
    std::map<Index3, double> filled;
    const double box = 8 * clipped.pitch * clipped.pitch * clipped.pitch;
    for (const Octant& octant : clipped.octants) {
        const Index3 of = {(octant.index[0] + 1) >> 1, (octant.index[1] + 1) >> 1, (octant.index[2] + 1) >> 1};
        if (lattice == Lattice::cubic) filled[of] += octant.volume;
        else
            for (const Index3& site : sites_of_box(of)) filled[site] += octant.volume / 2;
    }
    const double whole = lattice == Lattice::cubic ? box : 4 * box;
    return static_cast<std::size_t>(
        std::count_if(filled.begin(), filled.end(), [&](const auto& f) { return f.second >= share * whole; }));
}

}  // namespace phyxel
