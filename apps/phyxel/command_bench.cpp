#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "bench_registry.h"
#include "commands.h"
#include "phyxel/error.h"
#include "scene/scene_text.h"

namespace phyxel::cli {
namespace {

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

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string name;
        bench::Options options;
    };
    auto* command = app.add_subcommand("bench", "Runs the benchmarks, or one of them");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("NAME", arguments->name, "Which one; all of them when left out");
    command->add_flag("--json", arguments->options.as_json, "Prints the results as JSON");
    command->add_option("--mesh", arguments->options.mesh, "setup: this mesh instead of the bunny")->type_name("FILE");
    command->add_option("--nodes", arguments->options.nodes, "setup, cantilever: this number of nodes only")
        ->type_name("N");
    command->add_flag("--large", arguments->options.large, "setup: 200,000 nodes as well (4 GB of memory)");
    command->add_flag("--reference", arguments->options.reference,
                      "table-5.1: also the listing, coded line by line; cantilever: also finite elements");
    add_threads(*command, arguments->options.threads);
    command->footer(list_of_benches());
    command->callback([arguments, &exit_code] { exit_code = run_benches(arguments->name, arguments->options); });
}

}  // namespace phyxel::cli
