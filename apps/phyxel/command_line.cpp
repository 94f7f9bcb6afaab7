#include "command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>
#include <string>

#include "commands.h"
#include "phyxel/error.h"
#include "phyxel/version.h"
#include "scene/scene_text.h"

/// Everything that a user can type. CLI11 takes longer to compile than all else here, and is included nowhere else.

namespace phyxel::cli {
namespace {

/// The option `--threads N` that every command has.
void add_threads(CLI::App& command, int& threads) {
    command.add_option("--threads", threads, "Threads to use, 1 to 1024; the results do not depend on it")
        ->type_name("N")
        ->default_str("all of the machine's")
        ->check([](const std::string& text) {
            char* end = nullptr;
            const long value = std::strtol(text.c_str(), &end, 10);
            const bool good = !text.empty() && *end == '\0' && value >= 1 && value <= 1024;
            return good ? std::string() : "found '" + text + "', expected a whole number from 1 to 1024";
        });
}

void add_run(CLI::App& app, int& exit_code) {
    auto* command = app.add_subcommand("run", "Simulates a scene, writes its outputs and summary.json");
    auto arguments = std::make_shared<RunArguments>();
    command->add_option("SCENE", arguments->scene, "Scene file (TOML); docs/scene.md tells its keys")->required();
    command->add_option("-o,--output", arguments->folder, "Folder for all that is written")
        ->type_name("DIR")
        ->default_str("output/SCENE");
    command
        ->add_option("--set", arguments->overrides,
                     "Overrides a value, such as simulation.duration=0.5 or "
                     "material.jelly.youngs_modulus=1e5; may be repeated")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
    command
        ->add_option("--resume", arguments->resume,
                     "Goes on from a checkpoint, to the same bits as if it had never "
                     "stopped")
        ->type_name("CHECKPOINT");
    command->add_option("--fragments", arguments->fragments, "Writes each fragment of the last frame as a PLY file")
        ->type_name("DIR");
    add_threads(*command, arguments->threads);
    command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

/// `view`, which this version lacks: it has its help, and refuses to work.
void add_view(CLI::App& app) {
    struct Arguments {
        std::string scene, folder;
        int threads = 0;
    };
    auto* command = app.add_subcommand("view", "Shows a scene in a window (not available yet)");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("SCENE", arguments->scene);
    command->add_option("-o,--output", arguments->folder, "Folder for the results")->type_name("DIR");
    add_threads(*command, arguments->threads);
    command->callback([arguments] {
        throw Error(
            "'phyxel view' is not available yet in this version; "
            "use 'phyxel run SCENE --set output.formats=[\"mp4\"]' for a film");
    });
}

void add_check(CLI::App& app, int& exit_code) {
    auto* command = app.add_subcommand("check",
                                       "Says what a mesh is, what would be repaired, and whether it can be "
                                       "simulated");
    auto arguments = std::make_shared<CheckArguments>();
    command->add_option("MESH", arguments->mesh, "Mesh file: OBJ, PLY, STL, OFF, glTF or GLB")->required();
    command->add_option("--part", arguments->part, "Only the object or group of this name")->type_name("NAME");
    command->add_flag("--json", arguments->as_json, "Prints the report as JSON");
    add_threads(*command, arguments->threads);
    command->callback([arguments, &exit_code] { exit_code = check(*arguments); });
}

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

void add_study(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string name, folder;
        studies::Options options;
    };
    auto* command = app.add_subcommand("study", "Runs a published experiment; 'study list' names them");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("NAME", arguments->name, "Which one, or list")->required();
    command->add_option("-o,--output", arguments->folder, "Folder for the table and the picture")
        ->type_name("DIR")
        ->default_str("output/NAME");
    command->add_flag("--small", arguments->options.small, "Small sizes: a few seconds");
    add_threads(*command, arguments->options.threads);
    command->footer(list_of_studies());
    command->callback([arguments, &exit_code] {
        arguments->options.folder = arguments->folder;
        exit_code = run_study(arguments->name, arguments->options);
    });
}

std::string no_such_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return fmt::format("there is no command '{}'{}; see 'phyxel --help'", word, suggestion(word, names));
}

}  // namespace

int run_command_line(int argc, char** argv) {
    CLI::App app("Soft and breakable solids from bare surface meshes.", "phyxel");
    app.set_version_flag("--version", std::string("phyxel ") + version);
    app.require_subcommand(1);
    int exit_code = success;
    add_run(app, exit_code);
    add_view(app);
    add_check(app, exit_code);
    add_bench(app, exit_code);
    add_study(app, exit_code);
    try {
        app.parse(argc, argv);
        return exit_code;
    } catch (const CLI::ParseError& error) {
        // Asked for help or the version: no mistake
        if (error.get_exit_code() == 0) return app.exit(error);
        const auto given = app.get_subcommands();
        if (given.empty() && argc > 1 && argv[1][0] != '-') throw Error(no_such_command(app, argv[1]));
        throw Error(fmt::format("{}; see 'phyxel {}--help'", error.what(),
                                given.empty() ? "" : given.front()->get_name() + " "));
    }
}

}  // namespace phyxel::cli
