#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/threads.h"
#include "phyxel/vector.h"

namespace phyxel {

/// Sparse matrix of 3x3 blocks in single precision, row by row, columns ascending.
struct BlockMatrix {
    std::vector<std::size_t> offset{0};  ///< [rows + 1] into the rest
    std::vector<std::uint32_t> column;
    std::vector<Mat3f> value;

    std::size_t rows() const { return offset.size() - 1; }

    /// y = A x.
    void multiply(std::span<const Vec3f> x, std::span<Vec3f> y, const Threads& threads) const {
        threads.for_each(rows(), 64, [&](std::size_t i) {
            Vec3f sum{};
            for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) sum += value[k] * x[column[k]];
            y[i] = sum;
        });
    }
};

/// Rows of a block matrix while entries are added to them.
class BlockRows {
public:
    explicit BlockRows(std::size_t rows) : rows_(rows) {}

    void add(std::uint32_t row, std::uint32_t column, const Mat3& block);
    BlockMatrix compressed() const;

private:
    struct Entry {
        std::uint32_t column;
        Mat3 value;
    };
    std::vector<std::vector<Entry>> rows_;  ///< columns ascending
};

}  // namespace phyxel
