#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "phyxel/vector.h"

namespace phyxel {

/// A dense matrix in single precision, for products with three columns at once. Sixteen rows at a time are stored
/// column by column, so that a product reads straight on and keeps its sums in registers.
class Panel {
public:
    static constexpr std::size_t group = 16;  // rows stored together; the last group is filled up with zeros

    Panel() = default;
    Panel(std::size_t rows, std::size_t columns)
        : rows_(rows), columns_(columns), values_((rows + group - 1) / group * group * columns) {}

    /// First entry of a row; the entry of column j is `group * j` further on.
    float* row(std::size_t i) { return &values_[i / group * group * columns_ + i % group]; }
    const float* row(std::size_t i) const { return &values_[i / group * group * columns_ + i % group]; }
    float at(std::size_t i, std::size_t j) const { return row(i)[group * j]; }

    std::size_t rows() const { return rows_; }
    std::size_t columns() const { return columns_; }

    /// y = A x, x [columns], y [rows]. The same bits with and without AVX2.
    void multiply(std::span<const Vec3f> x, std::span<Vec3f> y) const;

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<float> values_;
};

}  // namespace phyxel
