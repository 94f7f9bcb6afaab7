#include "io/csv.h"

#include <fmt/format.h>

#include <cassert>
#include <iterator>

#include "io/finite_values.h"

namespace phyxel {
namespace {

std::string quoted(const std::string& name) {
    if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
    std::string result = "\"";
    for (const char c : name) result.append(c == '"' ? 2 : 1, c);
    return result += '"';
}

}  // namespace

CsvWriter::CsvWriter(const std::filesystem::path& path, std::span<const std::string> columns)
    : file_(path), columns_(columns.size()) {
    std::string line;
    for (const std::string& column : columns) {
        if (!line.empty()) line += ',';
        line += quoted(column);
    }
    file_.write(line += '\n');
}

void CsvWriter::add_row(std::span<const double> values) {
    assert(values.size() == columns_);
    require_finite(file_.target(), "values of a row", values);
    fmt::memory_buffer line;
    for (const double value : values) {
        if (line.size() > 0) line.push_back(',');
        fmt::format_to(std::back_inserter(line), "{}", value);
    }
    line.push_back('\n');
    file_.write(std::string_view(line.data(), line.size()));
}

}  // namespace phyxel
