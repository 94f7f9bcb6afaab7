#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "phyxel/world.h"
#include "studies/studies.h"

namespace phyxel::studies {

/// What a study found: rows of a table, printed as they come, and claims about them.
class Results {
public:
    using Cell = std::variant<std::string, double>;

    Results(std::string name, std::vector<std::string> columns, const Options& options);

    /// One cell a column.
    void add_row(std::vector<Cell> row);

    /// A second table beside the first, NAME-`part`.csv, written at once and not printed.
    void write_table(const std::string& part, const std::vector<std::string>& columns,
                     const std::vector<std::vector<Cell>>& rows) const;

    /// Claims, checked when `finish` is called; `what` says of what, with its unit.
    void expect_at_most(const std::string& what, double found, double most);
    void expect_at_least(const std::string& what, double found, double least);
    void expect(const std::string& what, bool holds);

    /// A world whose final state counts for the state hash of the study; or, where there is no world, a number found.
    void note(const World& world) { note(world.state_hash()); }
    void note(std::uint64_t state_hash);
    void note(double found) { note(std::bit_cast<std::uint64_t>(found)); }

    /// Writes the table and draws the picture; prints the claims and the state hash. The exit code: 0, or 1 when a
    /// claim failed.
    int finish();

private:
    struct Claim {
        std::string text;
        bool holds;
    };

    std::string name_;
    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
    std::vector<Claim> claims_;
    std::filesystem::path folder_;
    std::uint64_t hash_ = 0;

    void write(const std::string& file, const std::vector<std::string>& columns,
               const std::vector<std::vector<Cell>>& rows) const;
};

/// Slope of log(y) over log(x) by least squares.
double slope_of_logarithms(const std::vector<double>& x, const std::vector<double>& y);

/// Processor time of this process, all threads together [s].
double processor_seconds();

}  // namespace phyxel::studies
