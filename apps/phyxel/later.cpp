#include "commands.h"
#include "phyxel/error.h"

namespace phyxel::cli {
namespace {

/// A command of the contract that this version lacks: it has its help, and refuses to work.
void add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& argument,
                 const std::string& remedy) {
    struct Arguments {
        std::string argument, folder;
        int threads = 0;
    };
    auto* command = app.add_subcommand(name, what + " (not available yet)");
    auto arguments = std::make_shared<Arguments>();
    command->add_option(argument, arguments->argument);
    command->add_option("-o,--output", arguments->folder, "Folder for the results")->type_name("DIR");
    add_threads(*command, arguments->threads);
    command->callback([name, remedy, arguments] {
        throw Error("'phyxel " + name + "' is not available yet in this version; " + remedy);
    });
}

}  // namespace

void add_later(CLI::App& app) {
    add_command(app, "view", "Shows a scene in a window", "SCENE",
                "use 'phyxel run SCENE --set output.formats=[\"mp4\"]' for a film");
}

}  // namespace phyxel::cli
