#pragma once

#include <algorithm>
#include <cmath>

#include "phyxel/vector.h"

namespace phyxel {

/// max |A_ij|: what a matrix is divided by, so that squares of its entries neither over- nor underflow.
inline double largest_entry(const Mat3& A) {
    double largest = 0;
    for (const Vec3& row : A.rows) largest = std::max({largest, std::abs(row.x), std::abs(row.y), std::abs(row.z)});
    return largest;
}

}  // namespace phyxel
