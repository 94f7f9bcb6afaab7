#pragma once

#include <string_view>
#include <vector>

namespace phyxel::cli {

struct BenchOptions {
    int threads = 0;       ///< 0: all of the machine's
    bool as_json = false;  ///< one JSON value on standard output instead of a table
};

/// One benchmark: prints its table, returns the program's exit code.
struct Bench {
    std::string_view name;
    std::string_view what;
    int (*run)(const BenchOptions& options);
};

/// All benchmarks, in the order in which `phyxel bench` runs them.
const std::vector<Bench>& benches();

}  // namespace phyxel::cli
