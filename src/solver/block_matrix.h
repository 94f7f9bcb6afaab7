#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/threads.h"
#include "phyxel/vector.h"

namespace phyxel {

inline Mat3f to_float(const Mat3& A) {
    return {{vector_cast<float>(A.rows[0]), vector_cast<float>(A.rows[1]), vector_cast<float>(A.rows[2])}};
}
inline Mat3 to_double(const Mat3f& A) {
    return {{vector_cast<double>(A.rows[0]), vector_cast<double>(A.rows[1]), vector_cast<double>(A.rows[2])}};
}

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
