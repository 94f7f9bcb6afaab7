#pragma once

#include <string_view>
#include <vector>

#include "bench/benches.h"

namespace phyxel::cli {

/// One benchmark: prints its table, returns the program's exit code.
struct Bench {
    std::string_view name;
    std::string_view what;
    int (*run)(const bench::Options& options);
};

/// All benchmarks, in the order in which `phyxel bench` runs them.
const std::vector<Bench>& benches();

}  // namespace phyxel::cli
