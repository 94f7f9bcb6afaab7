#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "bench_registry.h"
#include "commands.h"
#include "phyxel/error.h"
#include "scene/scene_text.h"

namespace phyxel::cli {

int run_benches(const std::string& name, const bench::Options& options) {
    std::vector<std::string> names;
    for (const Bench& bench : benches()) names.emplace_back(bench.name);
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
        throw Error(fmt::format("there is no benchmark named '{}'{}", name, suggestion(name, names)));
    int exit_code = success;
    for (const Bench& bench : benches())
        if (name.empty() || bench.name == name) exit_code = std::max(exit_code, bench.run(options));
    return exit_code;
}

std::string list_of_benches() {
    std::string text = "Benchmarks:";
    for (const Bench& bench : benches()) text += fmt::format("\n  {:<12} {}", bench.name, bench.what);
    return benches().empty() ? text + " none yet" : text;
}

}  // namespace phyxel::cli
