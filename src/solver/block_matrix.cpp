#include "solver/block_matrix.h"

#include <algorithm>

namespace phyxel {

void BlockRows::add(std::uint32_t row, std::uint32_t column, const Mat3& block) {
    auto& entries = rows_[row];
    const auto place = std::lower_bound(entries.begin(), entries.end(), column,
                                        [](const Entry& entry, std::uint32_t c) { return entry.column < c; });
    if (place != entries.end() && place->column == column) place->value += block;
    else entries.insert(place, {column, block});
}

BlockMatrix BlockRows::compressed() const {
    BlockMatrix matrix;
    for (const auto& entries : rows_) {
        for (const Entry& entry : entries) {
            matrix.column.push_back(entry.column);
            matrix.value.push_back(to_float(entry.value));
        }
        matrix.offset.push_back(matrix.column.size());
    }
    return matrix;
}

}  // namespace phyxel
