#pragma once

#include <string_view>
#include <vector>

#include "studies/studies.h"

namespace phyxel::cli {

/// One study: prints its table, returns the program's exit code.
struct Study {
    std::string_view name;
    std::string_view what;
    int (*run)(const studies::Options& options);
};

/// All studies, in the order of `phyxel study list`.
const std::vector<Study>& all_studies();

}  // namespace phyxel::cli
