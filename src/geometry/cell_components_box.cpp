#include "geometry/cell_components_box.h"

#include <algorithm>
#include <bit>

namespace phyxel {
namespace {

using sub_voxel::Mask;

constexpr std::array<std::size_t, 3> octant_stride{4, 2, 1};

using BoxMasks = std::array<Mask, 8>;

/// Sub-voxels of octant `o` that a neighbour inside the box is set for.
Mask grown(const BoxMasks& part, std::size_t o) {
    Mask mask = part[o];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool upper = (o & octant_stride[axis]) != 0;
        const Mask next = part[o ^ octant_stride[axis]];
        mask |= sub_voxel::with_neighbor(part[o], upper ? sub_voxel::none : next, axis, 1);
        mask |= sub_voxel::with_neighbor(part[o], upper ? next : sub_voxel::none, axis, -1);
    }
    return mask;
}

/// Takes out of `remaining` the connected part that holds its first sub-voxel.
BoxMasks take_part(BoxMasks& remaining) {
    BoxMasks part{};
    for (std::size_t o = 0; o < 8; ++o)
        if (remaining[o]) {
            part[o] = remaining[o] & (~remaining[o] + 1);
            break;
        }
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t o = 0; o < 8; ++o) {
            const Mask mask = grown(part, o) & remaining[o];
            changed = changed || mask != part[o];
            part[o] = mask;
        }
    }
    for (std::size_t o = 0; o < 8; ++o) remaining[o] &= ~part[o];
    return part;
}

void unite(BoxPart& to, const BoxPart& from) {
    for (std::size_t o = 0; o < 8; ++o) {
        to.masks[o] |= from.masks[o];
        to.present[o] = to.present[o] || from.present[o];
    }
}

/// Whether two parts are joined within an octant or between two that share a face.
bool are_joined(const OctantMap& map, const LineOfSight& sight, const BoxPart& a, const BoxPart& b) {
    if (std::min(a.sub_voxels(), b.sub_voxels()) >= small_part) return false;
    for (std::size_t o = 0; o < 8; ++o)
        for (std::size_t p = 0; p < 8; ++p)
            if (a.present[o] && b.present[p] && std::popcount(o ^ p) <= 1 &&
                joined_by_line(map, sight, {a.octants[o], a.masks[o]}, {b.octants[p], b.masks[p]}))
                return true;
    return false;
}

/// Unites the parts from `begin` on that lines inside the solid join, until none are left.
void unite_joined(const OctantMap& map, const LineOfSight& sight, std::size_t begin, std::vector<BoxPart>& parts) {
    for (std::size_t a = begin; a < parts.size(); ++a)
        for (std::size_t b = a + 1; b < parts.size();) {
            if (are_joined(map, sight, parts[a], parts[b])) {
                unite(parts[a], parts[b]);
                parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(b));
                b = a + 1;
            } else {
                ++b;
            }
        }
}

std::size_t lowest_octant(const BoxPart& part) {
    return static_cast<std::size_t>(std::find(part.present.begin(), part.present.end(), true) - part.present.begin());
}

/// Points that stand for a share: the centres of its sub-voxels, or the centroid of a sliver.
struct SharePoints {
    std::size_t count = 0;
    std::array<Vec3, 64> points;
};

SharePoints share_points(const OctantMap& map, const Share& share) {
    SharePoints result;
    const Octant& octant = map.clip.octants[share.octant];
    if (share.mask == sub_voxel::none) {
        result.points[result.count++] = octant.centroid;
        return result;
    }
    const Vec3 corner = map.voxels.grid.corner(octant.index);
    for (Mask rest = share.mask; rest; rest &= rest - 1)
        result.points[result.count++] = corner + map.clip.pitch * sub_voxel::centroid(rest & (~rest + 1));
    return result;
}

}  // namespace

OctantMap::OctantMap(const ClippedVolume& clipped, const SubVoxels& sub_voxels)
    : clip(clipped), voxels(sub_voxels), octant_at(sub_voxels.grid.size(), absent) {
    for (std::size_t o = 0; o < clip.octants.size(); ++o)
        octant_at[voxels.grid.at(clip.octants[o].index)] = static_cast<std::uint32_t>(o);
}

int BoxPart::sub_voxels() const {
    int count = 0;
    for (Mask mask : masks) count += std::popcount(mask);
    return count;
}

bool joined_by_line(const OctantMap& map, const LineOfSight& sight, const Share& a, const Share& b) {
    const SharePoints from = share_points(map, a), to = share_points(map, b);
    double nearest = INFINITY;
    Vec3 start, end;
    for (std::size_t p = 0; p < from.count; ++p)
        for (std::size_t q = 0; q < to.count; ++q) {
            const double distance = norm_squared(from.points[p] - to.points[q]);
            if (distance >= nearest) continue;
            nearest = distance;
            start = from.points[p];
            end = to.points[q];
        }
    return sight.clear(start, end);
}

void append_box_parts(const OctantMap& map, const LineOfSight& sight, const std::array<int, 3>& box,
                      std::vector<BoxPart>& parts) {
    // The box's octants and their sub-voxels.
    BoxPart empty;
    empty.box = box;
    BoxMasks inside{};
    bool whole = true, any = false;
    for (std::size_t o = 0; o < 8; ++o) {
        std::array<int, 3> index;
        for (std::size_t c = 0; c < 3; ++c) index[c] = 2 * box[c] - ((o & octant_stride[c]) ? 0 : 1);
        empty.octants[o] = map.octant_at[map.voxels.grid.at(index)];
        if (empty.octants[o] != OctantMap::absent) inside[o] = map.mask(empty.octants[o]);
        whole = whole && inside[o] == sub_voxel::all;
        any = any || empty.octants[o] != OctantMap::absent;
    }
    if (!any) return;
    if (whole) {
        parts.push_back(empty);
        parts.back().masks = inside;
        parts.back().present.fill(true);
        return;
    }

    // Connected sub-voxels; then octants with solid but no sub-voxel, each by itself.
    const std::size_t begin = parts.size();
    BoxMasks remaining = inside;
    while (std::any_of(remaining.begin(), remaining.end(), [](Mask mask) { return mask != sub_voxel::none; })) {
        BoxPart part = empty;
        part.masks = take_part(remaining);
        for (std::size_t o = 0; o < 8; ++o) part.present[o] = part.masks[o] != sub_voxel::none;
        parts.push_back(part);
    }
    for (std::size_t o = 0; o < 8; ++o)
        if (empty.octants[o] != OctantMap::absent && inside[o] == sub_voxel::none) {
            parts.push_back(empty);
            parts.back().present[o] = true;
        }

    // What the sub-voxels are too coarse for.
    if (parts.size() == begin + 1) return;
    unite_joined(map, sight, begin, parts);
    std::stable_sort(parts.begin() + static_cast<std::ptrdiff_t>(begin), parts.end(),
                     [](const BoxPart& a, const BoxPart& b) { return lowest_octant(a) < lowest_octant(b); });
}

}  // namespace phyxel
