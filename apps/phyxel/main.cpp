/// phyxel - soft and breakable solids from bare surface meshes, on the command line.
///
/// Exit codes: 0 success; 2 a user's mistake, with one message on standard error; 1 anything else.

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>

#include "commands.h"
#include "phyxel/error.h"
#include "phyxel/version.h"
#include "scene/scene_text.h"

namespace phyxel::cli {
namespace {

int complain(std::string_view message, ExitCode code) {
    fmt::print(stderr, "phyxel: {}\n", message);
    return code;
}

std::string no_such_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return fmt::format("there is no command '{}'{}; see 'phyxel --help'", word, suggestion(word, names));
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

int run_program(int argc, char** argv) {
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
        if (given.empty() && argc > 1 && argv[1][0] != '-') return complain(no_such_command(app, argv[1]), mistake);
        return complain(fmt::format("{}; see 'phyxel {}--help'", error.what(),
                                    given.empty() ? "" : given.front()->get_name() + " "),
                        mistake);
    }
}

}  // namespace

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

}  // namespace phyxel::cli

int main(int argc, char** argv) {
    using namespace phyxel::cli;
    // A file or a pipe that takes no more is an error of writing, not the end of the program
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return run_program(argc, argv);
    } catch (const phyxel::Error& error) {
        return complain(error.what(), mistake);
    } catch (const std::bad_alloc&) {
        return complain("out of memory; raise the spacing of the bodies, or lower their count of nodes", failure);
    } catch (const std::exception& error) {
        return complain(fmt::format("internal error: {}", error.what()), failure);
    } catch (...) {
        return complain("internal error", failure);
    }
}
