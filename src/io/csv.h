#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "base/atomic_file.h"

namespace phyxel {

/// Writes a table row by row, with the digits that read back as the same numbers; the file appears when `finish` is
/// called. Fields are separated by commas, lines end with a line feed, a name with a comma or a quote is quoted.
class CsvWriter {
public:
    CsvWriter(const std::filesystem::path& path, std::span<const std::string> columns);

    /// One number a column; one that is not finite is an `Error`.
    void add_row(std::span<const double> values);

    void finish() { file_.commit(); }

private:
    AtomicFile file_;
    std::size_t columns_;
};

}  // namespace phyxel
