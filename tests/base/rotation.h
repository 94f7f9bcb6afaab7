#pragma once

#include <gtest/gtest.h>

#include "phyxel/vector.h"

namespace phyxel {

/// R^T R = I and det R = 1 to rounding.
inline void expect_rotation(const Mat3& R) {
    EXPECT_LE(norm(transpose(R) * R - Mat3::identity()), 5e-15);
    EXPECT_NEAR(determinant(R), 1, 5e-15);
}

}  // namespace phyxel
