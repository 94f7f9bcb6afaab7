#include "sampling/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/format.h"
#include "geometry/winding_number.h"
#include "phyxel/error.h"
#include "sampling/lattice_sites.h"
#include "sampling/memory_guard.h"

namespace phyxel {
namespace {

using Index3 = std::array<std::int32_t, 3>;

/// A cell or octant below this share of a whole one gets no node, or gives its volume away. Thresholds of 5 % and 25 %
/// would bend a beam's tip by -0.9 % and -3.4 % and shorten the stable step.
constexpr double smallest_share = 1e-3;

/// A share above this counts as whole; what is missing is rounding.
constexpr double whole_share = 1 - 1e-9;

struct Clipped {
    LatticeFrame frame;
    TriangleMesh mesh;
    ClippedVolume volume;
    double pitch;  ///< edge of a box
    double volume_scale = 1;
};

double box_pitch(const BodySettings& settings, double spacing) {
    return settings.lattice == Lattice::bcc ? spacing / 2 : spacing;
}

/// Scales volumes, and with them the boundary's areas, so that both closure identities stay.
void scale_volume(ClippedVolume& clipped, double factor) {
    for (Octant& octant : clipped.octants) octant.volume *= factor;
    for (SurfacePoint& point : clipped.boundary) point.area *= factor;
    clipped.volume *= factor;
}

Clipped clip(const CheckedMesh& checked, const BodySettings& settings, double spacing, const Threads& threads) {
    Clipped result;
    result.pitch = box_pitch(settings, spacing);
    result.frame =
        place_lattice(checked.mesh, rotation_matrix(settings.rotation), settings.lattice_rotation, result.pitch);
    Vec3 shift = settings.lattice_offset * spacing;
    // The boxes of a body-centred lattice have nodes at their corners, not at their centres.
    if (settings.lattice == Lattice::bcc) shift -= Vec3{0.5, 0.5, 0.5} * result.pitch;
    result.frame.origin += result.frame.rotation * shift;
    result.mesh = to_lattice(checked.mesh, result.frame);
    if (checked.closed_and_simple) {
        result.volume = clip_closed(result.mesh, result.pitch / 2, threads);
        return result;
    }
    // The surface does not bound a volume by itself.
    const WindingNumber winding(result.mesh);
    result.volume = clip_by_winding_number(result.mesh, winding, result.pitch / 2, threads);
    // Sub-voxels see the volume only as well as they are small: a body must not change its mass with its spacing.
    if (result.volume.volume > 0) result.volume_scale = checked.report.volume / result.volume.volume;
    scale_volume(result.volume, result.volume_scale);
    return result;
}

/// Gives every piece below 0.1 % of an octant to its largest neighbour in the same cell or in one that touches it.
std::size_t merge_slivers(std::vector<CellComponents::Piece>& pieces, const CellComponents& components,
                          double octant_volume) {
    const auto touches = [&](std::uint32_t a, std::uint32_t b) {
        if (a == b) return true;
        const auto begin = components.neighbors.begin() + components.neighbor_offset[a];
        const auto end = components.neighbors.begin() + components.neighbor_offset[a + 1];
        return std::find(begin, end, b) != end;
    };
    const auto by_octant = [](const CellComponents::Piece& a, const CellComponents::Piece& b) {
        return a.octant != b.octant ? a.octant < b.octant : a.cell < b.cell;
    };
    std::sort(pieces.begin(), pieces.end(), by_octant);
    std::vector<std::uint32_t> small;
    for (std::uint32_t p = 0; p < pieces.size(); ++p)
        if (pieces[p].volume < smallest_share * octant_volume) small.push_back(p);
    std::stable_sort(small.begin(), small.end(), [&](auto a, auto b) { return pieces[a].volume < pieces[b].volume; });

    std::size_t merged = 0;
    for (std::uint32_t p : small) {
        std::uint32_t best = no_index;
        for (int dk = -1; dk <= 1; ++dk)
            for (int dj = -1; dj <= 1; ++dj)
                for (int di = -1; di <= 1; ++di) {
                    CellComponents::Piece key = pieces[p];
                    key.octant[0] += di, key.octant[1] += dj, key.octant[2] += dk, key.cell = 0;
                    for (auto it = std::lower_bound(pieces.begin(), pieces.end(), key, by_octant);
                         it != pieces.end() && it->octant == key.octant; ++it) {
                        const auto q = static_cast<std::uint32_t>(it - pieces.begin());
                        if (q == p || it->volume <= 0 || !touches(pieces[p].cell, it->cell)) continue;
                        if (best == no_index || it->volume > pieces[best].volume) best = q;
                    }
                }
        if (best == no_index) continue;
        CellComponents::Piece &from = pieces[p], &to = pieces[best];
        to.centroid = (to.volume * to.centroid + from.volume * from.centroid) / (to.volume + from.volume);
        to.volume += from.volume;
        from.volume = 0;
        ++merged;
    }
    std::erase_if(pieces, [](const CellComponents::Piece& piece) { return piece.volume <= 0; });
    return merged;
}

/// Gauss point of a whole octant: 0.2113 a from the node planes, where two-point Gauss quadrature of the lattice cell
/// between nodes has its points.
Vec3 gauss_point(const Index3& octant, double a) {
    const double inset = 0.5 - 0.5 / std::sqrt(3.0);
    Vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = a * (((octant[c] + 1) >> 1) + ((octant[c] & 1) ? -inset : inset));
    return p;
}

std::uint8_t parity(const Index3& index) {
    return static_cast<std::uint8_t>((index[0] & 1) | (index[1] & 1) << 1 | (index[2] & 1) << 2);
}

void add_point(Sampling& s, const Vec3& position, double volume, std::uint32_t cell, std::uint32_t node,
               std::uint8_t kind) {
    s.points.push_back(position);
    s.volumes.push_back(volume);
    s.point_cell.push_back(cell);
    s.point_node.push_back(node);
    s.point_kind.push_back(kind);
}

/// Eight points a cell: one in each octant.
void add_octant_points(Sampling& s, const std::vector<CellComponents::Piece>& pieces) {
    const double whole = s.volume_scale * s.pitch * s.pitch * s.pitch / 8;
    for (const auto& piece : pieces) {
        const bool is_whole = std::abs(piece.volume / whole - 1) <= 1 - whole_share;
        add_point(s, is_whole ? gauss_point(piece.octant, s.pitch) : piece.centroid, piece.volume, piece.cell, no_index,
                  is_whole ? parity(piece.octant) : Sampling::irregular);
    }
}

/// One point in each box of a body-centred lattice: four a node.
void add_box_points(Sampling& s, const std::vector<double>& cell_volume) {
    const double whole = s.volume_scale * s.pitch * s.pitch * s.pitch;
    for (std::uint32_t c = 0; c < s.cell_box.size(); ++c) {
        if (cell_volume[c] <= 0) continue;
        const bool is_whole = std::abs(cell_volume[c] / whole - 1) <= 1 - whole_share;
        add_point(s, is_whole ? s.cell_centers[c] : s.cell_centroids[c], cell_volume[c], c, no_index,
                  is_whole ? parity(s.cell_box[c]) : Sampling::irregular);
    }
}

/// One point at each node, with the volume of the node's cells; a cell without a node gives its volume to the largest
/// cell that touches it and has one.
void add_node_points(Sampling& s, std::vector<double> cell_volume) {
    const auto has_node = [&](std::uint32_t c) {
        return s.cell_nodes[c][0] != no_index || s.cell_nodes[c][1] != no_index;
    };
    std::vector<double> given(cell_volume.size());
    for (std::uint32_t c = 0; c < cell_volume.size(); ++c) {
        if (has_node(c)) continue;
        std::uint32_t best = no_index;
        for (std::uint32_t k = s.neighbor_offset[c]; k < s.neighbor_offset[c + 1]; ++k) {
            const std::uint32_t n = s.neighbors[k];
            if (has_node(n) && (best == no_index || cell_volume[n] > cell_volume[best])) best = n;
        }
        if (best == no_index) add_point(s, s.cell_centroids[c], cell_volume[c], c, no_index, Sampling::irregular);
        else given[best] += cell_volume[c];
    }
    std::vector<double> node_volume(s.nodes.size());
    for (std::uint32_t c = 0; c < cell_volume.size(); ++c) {
        const auto& [first, second] = s.cell_nodes[c];
        const double volume = cell_volume[c] + given[c];
        if (first != no_index && second != no_index)
            node_volume[first] += volume / 2, node_volume[second] += volume / 2;
        else if (first != no_index || second != no_index) node_volume[first != no_index ? first : second] += volume;
    }
    const double whole = s.volume_scale * s.spacing * s.spacing * s.spacing / (s.lattice == Lattice::bcc ? 2 : 1);
    const auto kind = [&](std::uint32_t n) {
        return s.lattice == Lattice::bcc ? parity(s.cell_box[s.node_cell[n]]) : std::uint8_t{0};
    };
    for (std::uint32_t n = 0; n < s.nodes.size(); ++n) {
        const bool is_whole = std::abs(node_volume[n] / whole - 1) <= 1 - whole_share;
        add_point(s, s.nodes[n], node_volume[n], s.node_cell[n], n, is_whole ? kind(n) : Sampling::irregular);
    }
}

bool in_one_plane(std::span<const Vec3> nodes) {
    Vec3 e1{}, normal{};
    for (const Vec3& n : nodes)
        if (norm_squared(n - nodes[0]) > norm_squared(e1)) e1 = n - nodes[0];
    for (const Vec3& n : nodes)
        if (norm_squared(cross(e1, n - nodes[0])) > norm_squared(normal)) normal = cross(e1, n - nodes[0]);
    const double size = norm(e1);
    return std::all_of(nodes.begin(), nodes.end(),
                       [&](const Vec3& n) { return std::abs(dot(normalized(normal), n - nodes[0])) <= 1e-6 * size; });
}

void refuse_flat(const Sampling& s, const MeshReport& report) {
    if (s.nodes.size() >= 4 && !in_one_plane(s.nodes)) return;
    const Vec3 side = report.upper - report.lower;
    const double workable = std::min(std::min({side.x, side.y, side.z}) / 2, std::cbrt(report.volume / 64));
    throw Error("a spacing of " + format_number(s.spacing) + " m gives this body " + std::to_string(s.nodes.size()) +
                (s.nodes.size() < 4 ? " nodes; a body needs at least 4" : " nodes, all in one plane") +
                ". Use a spacing of " + format_number(workable) + " m or less");
}

}  // namespace

Sampling sample(const CheckedMesh& mesh, const BodySettings& settings, double spacing, const Threads& threads) {
    guard_memory(mesh.report, box_pitch(settings, spacing), spacing, settings.lattice == Lattice::bcc ? 2 : 1);
    Clipped clipped = clip(mesh, settings, spacing, threads);
    CellComponents components = find_components(clipped.mesh, clipped.volume, threads);

    Sampling s;
    s.frame = clipped.frame;
    s.lattice = settings.lattice;
    s.quadrature = settings.quadrature;
    s.spacing = spacing;
    s.pitch = clipped.pitch;
    s.split_boxes = components.split_boxes;
    s.volume_scale = clipped.volume_scale;

    // Cells and nodes.
    std::vector<double> cell_volume;
    for (const auto& cell : components.cells) {
        s.cell_box.push_back({cell.box[0], cell.box[1], cell.box[2]});
        s.cell_centers.push_back(Vec3{double(cell.box[0]), double(cell.box[1]), double(cell.box[2])} * s.pitch);
        s.cell_centroids.push_back(cell.centroid);
        cell_volume.push_back(cell.volume);
    }
    s.neighbor_offset = components.neighbor_offset;
    s.neighbors = components.neighbors;
    if (s.lattice == Lattice::cubic) place_cubic_nodes(s, cell_volume, smallest_share);
    else place_bcc_nodes(s, cell_volume, smallest_share);
    refuse_flat(s, mesh.report);

    // Quadrature points.
    if (s.quadrature == Quadrature::nodes) {
        add_node_points(s, cell_volume);
    } else if (s.lattice == Lattice::bcc) {
        add_box_points(s, cell_volume);
    } else {
        s.merged_octants = merge_slivers(components.pieces, components, s.pitch * s.pitch * s.pitch / 8);
        add_octant_points(s, components.pieces);
    }
    s.clipped_volume = std::accumulate(s.volumes.begin(), s.volumes.end(), 0.0);

    s.boundary = std::move(clipped.volume.boundary);
    s.boundary_cell.resize(s.boundary.size());
    threads.for_each(s.boundary.size(), 256,
                     [&](std::size_t b) { s.boundary_cell[b] = s.locate(s.boundary[b].position, s.boundary[b].area); });
    return s;
}

std::uint32_t Sampling::locate(const Vec3& position, const Vec3& outward) const {
    const Vec3 inside = position - normalized(outward) * (pitch / 8);
    const Index3 box = {static_cast<std::int32_t>(std::floor(inside.x / pitch + 0.5)),
                        static_cast<std::int32_t>(std::floor(inside.y / pitch + 0.5)),
                        static_cast<std::int32_t>(std::floor(inside.z / pitch + 0.5))};
    std::uint32_t best = no_index;
    double best_distance = 0;
    const auto consider = [&](const Index3& candidate) {
        for (auto it = std::lower_bound(cell_box.begin(), cell_box.end(), candidate);
             it != cell_box.end() && *it == candidate; ++it) {
            const auto c = static_cast<std::uint32_t>(it - cell_box.begin());
            const double distance = norm_squared(cell_centroids[c] - inside);
            if (best == no_index || distance < best_distance) best = c, best_distance = distance;
        }
    };
    consider(box);
    // Rounding may have put a point of the surface into a box that holds nothing.
    for (int reach = 1; reach <= 3 && best == no_index; ++reach)
        for (int dk = -reach; dk <= reach; ++dk)
            for (int dj = -reach; dj <= reach; ++dj)
                for (int di = -reach; di <= reach; ++di) consider({box[0] + di, box[1] + dj, box[2] + dk});
    if (best != no_index) return best;
    for (std::uint32_t c = 0; c < cell_centroids.size(); ++c)
        if (best == no_index || norm_squared(cell_centroids[c] - inside) < best_distance)
            best = c, best_distance = norm_squared(cell_centroids[c] - inside);
    return best;
}

double spacing_for_count(const CheckedMesh& mesh, const BodySettings& settings, const Threads& threads) {
    const double target = static_cast<double>(settings.count), per_cell = settings.lattice == Lattice::bcc ? 2 : 1;
    // Nodes in the volume, and those that stand half a spacing outside of it: N = V/a^3 + A/(2 a^2).
    double a = std::cbrt(per_cell * mesh.report.volume / target);
    for (int i = 0; i < 40; ++i) {
        const double n = estimate_nodes(mesh.report, a, per_cell);
        a *= std::cbrt(n / target);
    }
    double best = a, best_error = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 12 && best_error >= 0.02; ++i) {
        guard_memory(mesh.report, box_pitch(settings, a), a, per_cell);
        const Clipped clipped = clip(mesh, settings, a, threads);
        const auto found = static_cast<double>(count_nodes(clipped.volume, settings.lattice, smallest_share));
        const double error = std::abs(found / target - 1);
        if (found >= 4 && error < best_error) best = a, best_error = error;
        a *= found < 4 ? 0.8 : std::cbrt(found / target);
    }
    a = best;
    return a;
}

Sampling whole_cells(const std::array<int, 3>& counts, double spacing) {
    Sampling s;
    s.quadrature = Quadrature::nodes;
    s.spacing = s.pitch = spacing;
    const auto index = [&](int i, int j, int k) {
        return static_cast<std::uint32_t>(k + counts[2] * (j + counts[1] * i));
    };
    const double volume = spacing * spacing * spacing;
    s.neighbor_offset = {0};
    for (int i = 0; i < counts[0]; ++i)
        for (int j = 0; j < counts[1]; ++j)
            for (int k = 0; k < counts[2]; ++k) {
                const std::uint32_t n = index(i, j, k);
                const Vec3 X = Vec3{double(i), double(j), double(k)} * spacing;
                s.nodes.push_back(X);
                s.node_cell.push_back(n);
                s.cell_box.push_back({i, j, k});
                s.cell_centers.push_back(X);
                s.cell_centroids.push_back(X);
                s.cell_nodes.push_back({n, no_index});
                if (i > 0) s.neighbors.push_back(index(i - 1, j, k));
                if (j > 0) s.neighbors.push_back(index(i, j - 1, k));
                if (k > 0) s.neighbors.push_back(index(i, j, k - 1));
                if (k + 1 < counts[2]) s.neighbors.push_back(index(i, j, k + 1));
                if (j + 1 < counts[1]) s.neighbors.push_back(index(i, j + 1, k));
                if (i + 1 < counts[0]) s.neighbors.push_back(index(i + 1, j, k));
                s.neighbor_offset.push_back(static_cast<std::uint32_t>(s.neighbors.size()));
                add_point(s, X, volume, n, n, 0);
            }
    s.node_volumes.assign(s.nodes.size(), volume);
    s.clipped_volume = volume * static_cast<double>(s.nodes.size());
    return s;
}

}  // namespace phyxel
