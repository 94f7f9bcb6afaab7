#include "geometry/cell_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "geometry/clipping_shapes.h"
#include "geometry/winding_number.h"

namespace phyxel {
namespace {

struct Components {
    ClippedVolume clip;
    CellComponents cells;
};

Components components_of(const TriangleMesh& mesh, double spacing, int threads = 2) {
    ClippedVolume clip = clip_closed(mesh, spacing / 2, Threads(threads));
    CellComponents cells = find_components(mesh, clip, Threads(threads));
    return {std::move(clip), std::move(cells)};
}

bool are_neighbors(const CellComponents& cells, std::uint32_t a, std::uint32_t b) {
    return std::binary_search(cells.neighbors.begin() + cells.neighbor_offset[a],
                              cells.neighbors.begin() + cells.neighbor_offset[a + 1], b);
}

/// Cells reached from `start` over neighbours whose nodes lie within `reach` of `point`.
std::vector<bool> reached(const CellComponents& cells, std::uint32_t start, const Vec3& point, double spacing,
                          double reach) {
    std::vector<bool> seen(cells.cells.size());
    std::vector<std::uint32_t> stack{start};
    seen[start] = true;
    while (!stack.empty()) {
        const std::uint32_t c = stack.back();
        stack.pop_back();
        for (std::uint32_t n = cells.neighbor_offset[c]; n < cells.neighbor_offset[c + 1]; ++n) {
            const std::uint32_t to = cells.neighbors[n];
            const auto& box = cells.cells[to].box;
            const Vec3 node{box[0] * spacing, box[1] * spacing, box[2] * spacing};
            if (seen[to] || norm(node - point) >= reach) continue;
            seen[to] = true;
            stack.push_back(to);
        }
    }
    return seen;
}

std::size_t clusters(const CellComponents& cells) {
    std::size_t count = 0;
    std::vector<bool> seen(cells.cells.size());
    for (std::uint32_t c = 0; c < seen.size(); ++c) {
        if (seen[c]) continue;
        ++count;
        const std::vector<bool> cluster = reached(cells, c, {}, 1, INFINITY);
        for (std::size_t d = 0; d < seen.size(); ++d) seen[d] = seen[d] || cluster[d];
    }
    return count;
}

void expect_sound(const Components& parts, const std::string& name) {
    // Pieces make up their octants, and cells their pieces.
    std::map<std::array<int, 3>, std::pair<double, Vec3>> octants;
    std::vector<double> volumes(parts.cells.cells.size());
    for (const auto& piece : parts.cells.pieces) {
        auto& [volume, moment] = octants[piece.octant];
        volume += piece.volume;
        moment += piece.volume * piece.centroid;
        volumes[piece.cell] += piece.volume;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ((piece.octant[c] + 1) >> 1, parts.cells.cells[piece.cell].box[c]) << name;
    }
    ASSERT_EQ(octants.size(), parts.clip.octants.size()) << name;
    for (const Octant& o : parts.clip.octants) {
        const auto& [volume, moment] = octants[o.index];
        EXPECT_NEAR(volume, o.volume, 1e-14 * parts.clip.volume) << name;
        EXPECT_LT(norm(moment - o.volume * o.centroid), 1e-14 * parts.clip.volume * (1 + norm(o.centroid))) << name;
    }
    for (std::size_t c = 0; c < volumes.size(); ++c) EXPECT_EQ(volumes[c], parts.cells.cells[c].volume) << name;

    // Neighbours are sorted and mutual.
    for (std::uint32_t c = 0; c < volumes.size(); ++c)
        for (std::uint32_t n = parts.cells.neighbor_offset[c]; n < parts.cells.neighbor_offset[c + 1]; ++n) {
            EXPECT_NE(parts.cells.neighbors[n], c) << name;
            EXPECT_TRUE(are_neighbors(parts.cells, parts.cells.neighbors[n], c)) << name;
        }
}

TEST(CellComponents, pieces_keep_volume_and_first_moment_and_neighbors_are_mutual) {
    for (const auto& [name, mesh] : test_bodies())
        for (int pose = 0; pose < 3; ++pose) {
            const TriangleMesh body = pose == 0 ? mesh : posed(mesh, pose);
            const Components parts = components_of(body, body_size(body) / 9);
            expect_sound(parts, name);
            EXPECT_EQ(clusters(parts.cells), 1u) << name << " pose " << pose;
        }
}

TEST(CellComponents, boxes_of_a_convex_body_are_never_split) {
    for (int pose = 0; pose < 6; ++pose) {
        const TriangleMesh body = posed(pose % 2 ? make_sphere(1) : make_box({1, 2, 0.7}), pose);
        const Components parts = components_of(body, 0.23);
        EXPECT_EQ(parts.cells.split_boxes, 0u) << "pose " << pose;
    }
}

/// Two plates 4 x 4 x 2, side by side with a gap along z, turned and shifted by `seed` (0: aligned).
struct Plates {
    Plates(double size, int seed) : gap(size), middle(1 + size / 2) {
        const TriangleMesh plate = make_box({4, 4, 2});
        const TriangleMesh upper = transformed(plate, Mat3::identity(), {0, 0, 2 + gap});
        const TriangleMesh flat = joined(plate, upper);
        mesh = seed == 0 ? flat : posed(flat, seed);
        // Where the pose takes a frame.
        TriangleMesh frame;
        frame.vertices = {{0, 0, middle}, {0, 0, middle + 1}};
        if (seed != 0) frame = posed(frame, seed);
        center = frame.vertices[0];
        up = frame.vertices[1] - frame.vertices[0];
    }
    /// 1 above the gap, -1 below, 0 in it.
    int side(const Vec3& x) const {
        const double height = dot(x - center, up);
        return height > gap / 2 ? 1 : height < -gap / 2 ? -1 : 0;
    }

    double gap, middle;
    TriangleMesh mesh;
    Vec3 center, up;
};

/// The plate that a cell lies in: 1 above, -1 below; 0 where the centroid of a piece lies in the gap: an octant with
/// sub-voxels of one plate may hold a sliver of the other that no sub-voxel shows, and counts it to the one.
std::vector<int> sides_of(const CellComponents& cells, const Plates& plates) {
    std::vector<int> sides(cells.cells.size(), 2);
    for (const auto& piece : cells.pieces) {
        const int side = plates.side(piece.centroid);
        sides[piece.cell] = sides[piece.cell] == 2 || sides[piece.cell] == side ? side : 0;
    }
    return sides;
}

TEST(CellComponents, nothing_is_joined_across_a_gap_of_an_eighth_or_more_and_nothing_lost_within_a_plate) {
    const double spacing = 1, support = 2.2;
    for (double gap : {0.126, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0})
        for (int seed = 0; seed < 4; ++seed) {
            const Plates plates(gap, seed);
            const Components parts = components_of(plates.mesh, spacing);
            const auto& cells = parts.cells.cells;
            const std::vector<int> sides = sides_of(parts.cells, plates);
            const auto mixed = static_cast<std::size_t>(std::count(sides.begin(), sides.end(), 0));
            int wrong = 0, missed = 0;
            for (std::size_t p = 0; p < parts.cells.pieces.size(); p += 5) {
                const auto& piece = parts.cells.pieces[p];
                if (sides[piece.cell] == 0) continue;
                const auto seen = reached(parts.cells, piece.cell, piece.centroid, spacing, 1.25 * support);
                for (std::size_t c = 0; c < cells.size(); ++c) {
                    const Vec3 node{cells[c].box[0] * spacing, cells[c].box[1] * spacing, cells[c].box[2] * spacing};
                    if (norm(node - piece.centroid) >= support || cells[c].volume < 1e-3) continue;
                    missed += sides[c] == sides[piece.cell] && !seen[c];
                    wrong += sides[c] == -sides[piece.cell] && seen[c];
                }
            }
            EXPECT_EQ(wrong, 0) << "gap " << gap << " pose " << seed;
            EXPECT_EQ(missed, 0) << "gap " << gap << " pose " << seed;
            EXPECT_LT(mixed, cells.size() / 8) << "gap " << gap << " pose " << seed;
            EXPECT_EQ(clusters(parts.cells), 2u) << "gap " << gap << " pose " << seed;
        }
}

TEST(CellComponents, a_plate_thinner_than_a_sub_voxel_stays_one_body) {
    for (double thickness : {0.2, 0.1, 0.05, 0.01})
        for (int seed = 0; seed < 4; ++seed) {
            const TriangleMesh flat = make_box({4, 3, thickness}), plate = seed == 0 ? flat : posed(flat, seed);
            const Components parts = components_of(plate, 1);
            expect_sound(parts, "plate");
            EXPECT_EQ(clusters(parts.cells), 1u) << "thickness " << thickness << " pose " << seed;
            EXPECT_EQ(parts.cells.split_boxes, 0u) << "thickness " << thickness << " pose " << seed;
        }
}

/// Two bars 2 x 3 x 2 on a common foot, a slot of 0.2 between them: one closed surface.
TriangleMesh slotted_block() {
    const std::vector<Vec3> outline{{0, 0, 0},   {4.2, 0, 0}, {4.2, 4, 0}, {2.2, 4, 0},
                                    {2.2, 1, 0}, {2, 1, 0},   {2, 4, 0},   {0, 4, 0}};
    const std::vector<Triangle> face{{0, 5, 6}, {0, 6, 7}, {0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}};
    TriangleMesh mesh;
    mesh.vertices = outline;
    for (const Vec3& v : outline) mesh.vertices.push_back(v + Vec3{0, 0, 2});
    for (const Triangle& t : face) {
        mesh.triangles.push_back({t[0], t[2], t[1]});
        mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    }
    for (std::uint32_t v = 0; v < 8; ++v) {
        const std::uint32_t w = (v + 1) % 8;
        mesh.triangles.push_back({v, w, w + 8});
        mesh.triangles.push_back({v, w + 8, v + 8});
    }
    return mesh;
}

TEST(CellComponents, a_slot_keeps_its_sides_apart_and_its_foot_together) {
    for (int seed = 0; seed < 4; ++seed) {
        const TriangleMesh block = slotted_block(), body = seed == 0 ? block : posed(block, seed);
        const Components parts = components_of(body, 1);
        expect_sound(parts, "slot");
        EXPECT_GT(parts.cells.split_boxes, 3u) << "pose " << seed;
        EXPECT_EQ(clusters(parts.cells), 1u) << "pose " << seed;

        // At the tips of the bars no cell of one bar is next to one of the other.
        TriangleMesh frame;
        frame.vertices = {{2.1, 1.9, 0}, {3.1, 1.9, 0}, {2.1, 2.9, 0}};
        if (seed != 0) frame = posed(frame, seed);
        const Vec3 origin = frame.vertices[0], across = frame.vertices[1] - origin, up = frame.vertices[2] - origin;
        for (std::uint32_t c = 0; c < parts.cells.cells.size(); ++c)
            for (std::uint32_t n = parts.cells.neighbor_offset[c]; n < parts.cells.neighbor_offset[c + 1]; ++n) {
                const Vec3 a = parts.cells.cells[c].centroid - origin;
                const Vec3 b = parts.cells.cells[parts.cells.neighbors[n]].centroid - origin;
                const bool tips = dot(a, up) > 0 && dot(b, up) > 0;
                EXPECT_FALSE(tips && dot(a, across) * dot(b, across) < 0) << "pose " << seed;
            }
    }
}

TEST(CellComponents, a_sub_voxel_clipped_body_has_the_same_parts) {
    const Plates plates(0.3, 2);
    const WindingNumber winding(plates.mesh);
    const ClippedVolume clip = clip_by_winding_number(plates.mesh, winding, 0.5, Threads(2));
    const Components parts{clip, find_components(plates.mesh, clip, Threads(2))};
    expect_sound(parts, "plates");
    EXPECT_EQ(clusters(parts.cells), 2u);
}

TEST(CellComponents, gives_the_same_bits_for_any_number_of_threads) {
    const TriangleMesh body = posed(bunny(), 1);
    const Components one = components_of(body, body_size(body) / 12, 1);
    for (int count : {2, 3, 8}) {
        const Components many = components_of(body, body_size(body) / 12, count);
        EXPECT_EQ(one.cells.neighbors, many.cells.neighbors);
        EXPECT_EQ(one.cells.neighbor_offset, many.cells.neighbor_offset);
        ASSERT_EQ(one.cells.pieces.size(), many.cells.pieces.size());
        for (std::size_t p = 0; p < one.cells.pieces.size(); ++p) {
            EXPECT_EQ(one.cells.pieces[p].volume, many.cells.pieces[p].volume);
            EXPECT_TRUE(same_bits(one.cells.pieces[p].centroid, many.cells.pieces[p].centroid));
        }
    }
}

}  // namespace
}  // namespace phyxel
