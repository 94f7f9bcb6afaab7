#include "studies/results.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "studies/picture.h"

namespace phyxel::studies {
namespace {

constexpr int narrowest_column = 12;

using Cell = Results::Cell;

/// For people: five digits.
std::string printed(const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return fmt::format("{:.5g}", std::get<double>(cell));
}

/// For programs: the digits that read back as the same number; names with commas are quoted.
std::string written(const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell))
        return text->find(',') == text->npos ? *text : '"' + *text + '"';
    return fmt::format("{}", std::get<double>(cell));
}

int width(const std::string& column) { return std::max(narrowest_column, int(column.size())); }

}  // namespace

Results::Results(std::string name, std::vector<std::string> columns, const Options& options)
    : name_(std::move(name)), columns_(std::move(columns)), folder_(options.folder) {
    create_folder(folder_);
    for (const std::string& column : columns_) fmt::print("{:<{}}  ", column, width(column));
    fmt::print("\n");
}

void Results::add_row(std::vector<Cell> row) {
    assert(row.size() == columns_.size());
    for (std::size_t c = 0; c < row.size(); ++c) fmt::print("{:<{}}  ", printed(row[c]), width(columns_[c]));
    fmt::print("\n");
    std::fflush(stdout);
    rows_.push_back(std::move(row));
}

void Results::write_table(const std::string& part, const std::vector<std::string>& columns,
                          const std::vector<std::vector<Cell>>& rows) const {
    write(name_ + "-" + part + ".csv", columns, rows);
}

void Results::write(const std::string& file, const std::vector<std::string>& columns,
                    const std::vector<std::vector<Cell>>& rows) const {
    std::string text = fmt::format("{}\n", fmt::join(columns, ","));
    for (const auto& row : rows) {
        std::vector<std::string> cells;
        for (const Cell& cell : row) cells.push_back(written(cell));
        text += fmt::format("{}\n", fmt::join(cells, ","));
    }
    write_file(folder_ / file, text);
}

void Results::expect_at_most(const std::string& what, double found, double most) {
    claims_.push_back({fmt::format("{}: {:.4g}, at most {:.4g}", what, found, most), found <= most});
}

void Results::expect_at_least(const std::string& what, double found, double least) {
    claims_.push_back({fmt::format("{}: {:.4g}, at least {:.4g}", what, found, least), found >= least});
}

void Results::expect(const std::string& what, bool holds) { claims_.push_back({what, holds}); }

void Results::note(std::uint64_t state_hash) {
    Hasher hasher;
    hasher.add_value(hash_);
    hasher.add_value(state_hash);
    hash_ = hasher.value();
}

int Results::finish() {
    write(name_ + ".csv", columns_, rows_);
    fmt::print("\n{}\n", (folder_ / (name_ + ".csv")).string());
    const Drawing drawing = draw_picture(name_, folder_);
    if (drawing.trouble.empty()) fmt::print("{}\n", (folder_ / (name_ + ".png")).string());
    else fmt::print(stderr, "phyxel: no picture: {}\n", drawing.trouble);
    expect("the picture could be drawn, where there is what it takes", !drawing.failed);
    if (hash_ != 0) fmt::print("state hash {:016x}\n", hash_);

    fmt::print("\n");
    bool all = true;
    for (const Claim& claim : claims_) {
        fmt::print("{:<8}{}\n", claim.holds ? "holds" : "FAILS", claim.text);
        if (!claim.holds) fmt::print(stderr, "phyxel: study {}: a claim failed: {}\n", name_, claim.text);
        all = all && claim.holds;
    }
    return all ? 0 : 1;
}

double slope_of_logarithms(const std::vector<double>& x, const std::vector<double>& y) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    const double n = double(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double u = std::log(x[i]), v = std::log(y[i]);
        sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

}  // namespace phyxel::studies
