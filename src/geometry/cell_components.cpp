#include "geometry/cell_components.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "geometry/cell_components_box.h"
#include "geometry/line_of_sight.h"
#include "geometry/sub_voxels.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

using sub_voxel::Mask;

/// A mesh that was clipped as closed needs a winding number only where lines along z find it open after all.
std::shared_ptr<const SubVoxels> sub_voxels_of(const TriangleMesh& mesh, const ClippedVolume& clip,
                                               const Threads& threads) {
    if (clip.sub_voxels) return clip.sub_voxels;
    std::optional<SubVoxels> closed = sub_voxels_by_columns(mesh, clip.pitch, threads);
    return std::make_shared<const SubVoxels>(
        closed ? std::move(*closed) : sub_voxels_by_winding_number(mesh, WindingNumber(mesh), clip.pitch, threads));
}

/// The parts of all boxes, by box.
std::vector<BoxPart> all_parts(const OctantMap& map, const LineOfSight& sight, const Threads& threads) {
    const OctantGrid& grid = map.voxels.grid;
    std::array<int, 3> first, last;
    for (std::size_t c = 0; c < 3; ++c) {
        first[c] = (grid.first[c] + 2) >> 1;
        last[c] = (grid.first[c] + grid.extent[c] - 1) >> 1;
    }
    std::vector<std::vector<BoxPart>> planes(static_cast<std::size_t>(last[0] - first[0] + 1));
    threads.for_each(planes.size(), 1, [&](std::size_t plane) {
        for (int j = first[1]; j <= last[1]; ++j)
            for (int k = first[2]; k <= last[2]; ++k)
                append_box_parts(map, sight, {first[0] + static_cast<int>(plane), j, k}, planes[plane]);
    });
    std::vector<BoxPart> parts;
    for (const std::vector<BoxPart>& plane : planes) parts.insert(parts.end(), plane.begin(), plane.end());
    return parts;
}

/// A piece's share of its octant's volume and first moment, by its share of the sub-voxels. All pieces are moved alike,
/// from where their sub-voxels are, so that the octant's first moment is kept.
void set_piece(const OctantMap& map, const Share& share, CellComponents::Piece& piece) {
    const Octant& octant = map.clip.octants[share.octant];
    const Mask all = map.mask(share.octant);
    piece.octant = octant.index;
    piece.volume = octant.volume;
    piece.centroid = octant.centroid;
    if (share.mask == all) return;
    piece.volume *= static_cast<double>(std::popcount(share.mask)) / std::popcount(all);
    piece.centroid += map.clip.pitch * (sub_voxel::centroid(share.mask) - sub_voxel::centroid(all));
}

/// The pieces again by octant, with what adjacency needs.
struct OctantPieces {
    std::vector<Share> shares;          ///< [pieces]
    std::vector<std::uint32_t> offset;  ///< [octants + 1] into `order`
    std::vector<std::uint32_t> order;   ///< [pieces] octant by octant
};

/// Fills cells and pieces.
OctantPieces set_cells(const OctantMap& map, const std::vector<BoxPart>& parts, CellComponents& result) {
    OctantPieces index;
    for (std::size_t c = 0; c < parts.size(); ++c) {
        const BoxPart& part = parts[c];
        CellComponents::Cell cell;
        cell.box = part.box;
        Vec3 moment;
        for (std::size_t o = 0; o < 8; ++o) {
            if (!part.present[o]) continue;
            index.shares.push_back({part.octants[o], part.masks[o]});
            CellComponents::Piece piece;
            piece.cell = static_cast<std::uint32_t>(c);
            set_piece(map, index.shares.back(), piece);
            result.pieces.push_back(piece);
            cell.volume += piece.volume;
            moment += piece.volume * piece.centroid;
        }
        cell.centroid = moment / cell.volume;
        result.cells.push_back(cell);
        const bool starts = c == 0 || parts[c - 1].box != part.box;
        if (!starts && (c == 1 || parts[c - 2].box != part.box)) ++result.split_boxes;
    }

    // Octant by octant.
    index.offset.assign(map.clip.octants.size() + 1, 0);
    for (const Share& share : index.shares) ++index.offset[share.octant + 1];
    for (std::size_t o = 1; o < index.offset.size(); ++o) index.offset[o] += index.offset[o - 1];
    index.order.resize(index.shares.size());
    std::vector<std::uint32_t> next(index.offset.begin(), index.offset.end() - 1);
    for (std::size_t p = 0; p < index.shares.size(); ++p)
        index.order[next[index.shares[p].octant]++] = static_cast<std::uint32_t>(p);
    return index;
}

/// Calls `visit(q, axis, step)` for every piece q of the octants across the faces that piece p's octant has on the
/// outside of its box.
template <class Visit>
void visit_across(const OctantMap& map, const OctantPieces& index, const CellComponents& components, std::size_t p,
                  Visit&& visit) {
    const std::array<int, 3>& octant = components.pieces[p].octant;
    const OctantGrid& grid = map.voxels.grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int step = (octant[axis] & 1) ? -1 : 1;
        const std::size_t here = grid.at(octant), stride = grid.stride(axis);
        const std::uint32_t across = map.octant_at[step > 0 ? here + stride : here - stride];
        if (across == OctantMap::absent) continue;
        for (std::uint32_t n = index.offset[across]; n < index.offset[across + 1]; ++n)
            visit(index.order[n], axis, step);
    }
}

void sort_unique(std::vector<std::uint32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Cells joined to cell `c`, whose pieces are [begin, end): those whose sub-voxels share a face with its own, and,
/// where one of the two is small, those that a line inside the solid joins.
std::vector<std::uint32_t> neighbors_of(const OctantMap& map, const LineOfSight& sight, const OctantPieces& index,
                                        const CellComponents& components, const std::vector<BoxPart>& parts,
                                        std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> touching;
    std::vector<std::pair<std::size_t, std::size_t>> near;
    for (std::size_t p = begin; p < end; ++p)
        visit_across(map, index, components, p, [&](std::size_t q, std::size_t axis, int step) {
            const Mask mask = index.shares[p].mask;
            if (mask & sub_voxel::with_neighbor(sub_voxel::none, index.shares[q].mask, axis, step))
                touching.push_back(components.pieces[q].cell);
            else near.push_back({std::min(p, q), std::max(p, q)});
        });
    sort_unique(touching);

    std::vector<std::uint32_t> joined;
    for (const auto& [p, q] : near) {
        const std::uint32_t own = components.pieces[begin].cell;
        const std::uint32_t other =
            components.pieces[p].cell == own ? components.pieces[q].cell : components.pieces[p].cell;
        if (std::binary_search(touching.begin(), touching.end(), other)) continue;
        if (std::find(joined.begin(), joined.end(), other) != joined.end()) continue;
        if (std::min(parts[own].sub_voxels(), parts[other].sub_voxels()) >= small_part) continue;
        if (joined_by_line(map, sight, index.shares[p], index.shares[q])) joined.push_back(other);
    }
    touching.insert(touching.end(), joined.begin(), joined.end());
    sort_unique(touching);
    return touching;
}

using NeighborLists = std::vector<std::vector<std::uint32_t>>;

/// Cells joined directly or through others, as the lowest cell among them.
std::vector<std::uint32_t> clusters_of(const NeighborLists& neighbors) {
    std::vector<std::uint32_t> cluster(neighbors.size(), OctantMap::absent), stack;
    for (std::uint32_t c = 0; c < neighbors.size(); ++c) {
        if (cluster[c] != OctantMap::absent) continue;
        cluster[c] = c;
        stack.push_back(c);
        while (!stack.empty()) {
            const std::uint32_t from = stack.back();
            stack.pop_back();
            for (std::uint32_t to : neighbors[from])
                if (cluster[to] == OctantMap::absent) {
                    cluster[to] = c;
                    stack.push_back(to);
                }
        }
    }
    return cluster;
}

/// Slivers that see no other part, because the solid curves away or because one octant holds slivers of two parts,
/// would fall off as crumbs. Every cluster of slivers of less than an octant is joined to the largest cell next to it,
/// and to that one only: it leads nowhere else.
void attach_crumbs(const OctantMap& map, const OctantPieces& index, const CellComponents& components,
                   const std::vector<BoxPart>& parts, NeighborLists& neighbors) {
    std::vector<std::uint32_t> slivers;
    for (std::uint32_t c = 0; c < parts.size(); ++c)
        if (parts[c].sub_voxels() == 0) slivers.push_back(c);
    if (slivers.empty()) return;

    // Clusters without sub-voxels.
    const std::vector<std::uint32_t> cluster = clusters_of(neighbors);
    std::vector<double> volume(parts.size());
    std::vector<bool> solid(parts.size());
    for (std::size_t c = 0; c < parts.size(); ++c) {
        volume[cluster[c]] += components.cells[c].volume;
        solid[cluster[c]] = solid[cluster[c]] || parts[c].sub_voxels() > 0;
    }
    const double octant = map.clip.pitch * map.clip.pitch * map.clip.pitch;

    // The largest cell next to each: across a face, or in an octant of the same box.
    struct Link {
        std::uint32_t from = OctantMap::absent, to = 0;
    };
    std::vector<Link> links(parts.size());
    const auto consider = [&](std::uint32_t from, std::uint32_t to) {
        Link& link = links[cluster[from]];
        if (cluster[to] == cluster[from]) return;
        if (link.from == OctantMap::absent || components.cells[to].volume > components.cells[link.to].volume)
            link = {from, to};
    };
    for (std::size_t p = 0; p < components.pieces.size(); ++p) {
        const std::uint32_t c = components.pieces[p].cell;
        if (solid[cluster[c]] || volume[cluster[c]] >= octant) continue;
        visit_across(map, index, components, p,
                     [&](std::size_t q, std::size_t, int) { consider(c, components.pieces[q].cell); });
        for (std::uint32_t d = c; d-- > 0 && parts[d].box == parts[c].box;) consider(c, d);
        for (std::uint32_t d = c + 1; d < parts.size() && parts[d].box == parts[c].box; ++d) consider(c, d);
    }
    for (const Link& link : links) {
        if (link.from == OctantMap::absent) continue;
        neighbors[link.from].push_back(link.to);
        neighbors[link.to].push_back(link.from);
        sort_unique(neighbors[link.from]);
        sort_unique(neighbors[link.to]);
    }
}

}  // namespace

CellComponents find_components(const TriangleMesh& mesh, const ClippedVolume& clip, const Threads& threads) {
    const std::shared_ptr<const SubVoxels> voxels = sub_voxels_of(mesh, clip, threads);
    const OctantMap map(clip, *voxels);
    const LineOfSight sight(mesh);

    CellComponents result;
    const std::vector<BoxPart> parts = all_parts(map, sight, threads);
    const OctantPieces index = set_cells(map, parts, result);

    // Pieces are sorted by cell.
    std::vector<std::size_t> begin(parts.size() + 1);
    for (const CellComponents::Piece& piece : result.pieces) ++begin[piece.cell + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());

    NeighborLists neighbors(parts.size());
    threads.for_each(parts.size(), 256, [&](std::size_t c) {
        neighbors[c] = neighbors_of(map, sight, index, result, parts, begin[c], begin[c + 1]);
    });
    attach_crumbs(map, index, result, parts, neighbors);

    result.neighbor_offset.push_back(0);
    for (const std::vector<std::uint32_t>& list : neighbors) {
        result.neighbors.insert(result.neighbors.end(), list.begin(), list.end());
        result.neighbor_offset.push_back(static_cast<std::uint32_t>(result.neighbors.size()));
    }
    return result;
}

}  // namespace phyxel
