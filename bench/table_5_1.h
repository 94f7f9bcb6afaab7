#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "phyxel/vector.h"

/// The seven bodies of table 5.1 of C. Stegmayr, "Procedural deformation and destruction in real-time", Master thesis,
/// 2008, which gives node count, mean number of neighbours and frames a second, and no more.
///
/// The counts 48, 100, 180, 294, 448, 1210 are n (n + 1)^2: simple cubic grids, though the thesis speaks of
/// body-centred ones. The support is not printed either; here it is that full shell of lattice neighbours which comes
/// nearest to the printed mean. The means so found differ from the printed ones by up to 3.2 % (grids stretched along x
/// or staggered by layers came no nearer), so that times should be compared per node pair, or with that margin.

namespace phyxel::bench {

/// One line of the table. Neighbours include the node itself, as in the thesis (section 3.2.3).
struct TableBody {
    std::array<std::size_t, 3> nodes;  ///< along x, y, z
    int shell_squared;                 ///< neighbours are those with |X_ij|^2 <= shell_squared spacing^2
    double thesis_neighbors;           ///< mean, as printed
    double thesis_frames_per_second;   ///< as printed [1/s], on a quad-core Xeon of 2.33 GHz
    double mean_neighbors;             ///< mean, of this body
};

inline constexpr std::array<TableBody, 7> table_5_1 = {{
    {{3, 4, 4}, 9, 37.9, 227.8, 1780.0 / 48},
    {{4, 5, 5}, 14, 74.9, 83.5, 7640.0 / 100},
    {{5, 6, 6}, 16, 104.4, 44.0, 18200.0 / 180},
    {{6, 7, 7}, 17, 133.5, 21.6, 39442.0 / 294},
    {{7, 8, 8}, 14, 127.7, 12.3, 58940.0 / 448},
    {{7, 8, 8}, 27, 248.3, 8.2, 109792.0 / 448},
    {{10, 11, 11}, 8, 66.6, 7.2, 83108.0 / 1210},
}};

inline std::size_t node_count(const TableBody& body) { return body.nodes[0] * body.nodes[1] * body.nodes[2]; }

/// Support radius h [m]: a thousandth of the spacing beyond the outermost shell, where the weight is still above zero.
inline double support(const TableBody& body, double spacing) {
    return (std::sqrt(body.shell_squared) + 1e-3) * spacing;
}

/// Rest positions [m], z fastest. Each node owns a whole cell: volume spacing^3, mass density spacing^3.
inline std::vector<Vec3> positions(const TableBody& body, double spacing) {
    std::vector<Vec3> X;
    X.reserve(node_count(body));
    for (std::size_t x = 0; x < body.nodes[0]; ++x)
        for (std::size_t y = 0; y < body.nodes[1]; ++y)
            for (std::size_t z = 0; z < body.nodes[2]; ++z)
                X.push_back(spacing * Vec3{double(x), double(y), double(z)});
    return X;
}

}  // namespace phyxel::bench
