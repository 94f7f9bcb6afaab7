#include "model/dilatation_cells.h"

#include <algorithm>
#include <cmath>

namespace phyxel {
namespace {

using Index3 = std::array<std::int32_t, 3>;

/// Lattice cell of a point: the cube whose corners are the nodes around it, or the conventional cell of a body-centred
/// lattice, eight boxes. (The cells of the nodes, more of them, lock a little: at nu = 0.4999 a beam two cells thick
/// then bends 1.7 % too little, with these 0.6 % too much.)
Index3 lattice_cell(const Sampling& s, std::uint32_t q) {
    Index3 cell;
    for (int c = 0; c < 3; ++c)
        cell[c] = s.lattice == Lattice::bcc ? s.cell_box[s.point_cell[q]][c] >> 1
                                            : static_cast<std::int32_t>(std::floor(s.points[q][c] / s.pitch));
    return cell;
}

bool touch(const Sampling& s, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t cell = s.point_cell[a], other = s.point_cell[b];
    const auto begin = s.neighbors.begin() + s.neighbor_offset[cell];
    return cell == other || std::find(begin, s.neighbors.begin() + s.neighbor_offset[cell + 1], other) !=
                                s.neighbors.begin() + s.neighbor_offset[cell + 1];
}

/// A point on its way into a group.
struct Candidate {
    Index3 cell;
    std::uint16_t material;
    std::uint32_t point;
    auto operator<=>(const Candidate&) const = default;
};

/// Splits candidates of one cell and material into parts that hang together; `emit(points)` for each.
template <class Emit>
void connected_parts(const Sampling& s, std::span<const Candidate> all, Emit&& emit) {
    std::vector<std::uint32_t> left, part;
    for (const Candidate& c : all) left.push_back(c.point);
    while (!left.empty()) {
        part.assign(1, left.front());
        left.erase(left.begin());
        for (std::size_t k = 0; k < part.size(); ++k)
            std::erase_if(left, [&](std::uint32_t q) { return touch(s, part[k], q) && (part.push_back(q), true); });
        std::sort(part.begin(), part.end());
        emit(part);
    }
}

}  // namespace

DilatationCells group_points(const Model& m, std::optional<bool> wanted) {
    const Sampling& s = m.sampling;
    if (s.quadrature == Quadrature::nodes) return {};
    std::vector<Candidate> candidates;
    for (std::uint32_t q = 0; q < s.points.size(); ++q) {
        const std::uint16_t material = m.mixture.empty() ? std::uint16_t{0} : m.mixture.main_material(q);
        const Material& of = m.mixture.empty() ? m.settings : m.mixture.materials[material];
        if (wanted.value_or(of.poissons_ratio > nearly_incompressible))
            candidates.push_back({lattice_cell(s, q), material, q});
    }
    if (candidates.empty()) return {};
    std::sort(candidates.begin(), candidates.end());

    DilatationCells cells;
    cells.cell.assign(s.points.size(), no_index);
    cells.offset.push_back(0);
    const auto emit = [&](const std::vector<std::uint32_t>& points) {
        double volume = 0, lambda = 0;
        for (std::uint32_t q : points) {
            cells.cell[q] = static_cast<std::uint32_t>(cells.volume.size());
            volume += m.volumes[q];
            lambda += m.volumes[q] * m.point_material(q).lame.lambda;
        }
        cells.points.insert(cells.points.end(), points.begin(), points.end());
        cells.offset.push_back(static_cast<std::uint32_t>(cells.points.size()));
        cells.volume.push_back(volume);
        cells.lambda.push_back(lambda / volume);
    };
    for (auto begin = candidates.begin(); begin != candidates.end();) {
        const auto end = std::find_if(begin, candidates.end(), [&](const Candidate& c) {
            return c.cell != begin->cell || c.material != begin->material;
        });
        connected_parts(s, std::span(begin, end), emit);
        begin = end;
    }
    return cells;
}

}  // namespace phyxel
