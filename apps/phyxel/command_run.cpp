#include <fmt/format.h>

#include <csignal>
#include <cstdio>

#include "commands.h"
#include "progress_bar.h"

namespace phyxel::cli {
namespace {

volatile std::sig_atomic_t interrupt_asked = 0;

void ask_interrupt(int) { interrupt_asked = 1; }

/// The first signal ends the run in good order, the second one the program.
void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = ask_interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

struct Arguments {
    std::string scene, folder, resume, fragments;
    std::vector<std::string> overrides;
    int threads = 0;
};

RunResult simulate(const Arguments& arguments) {
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    catch_interrupts();
    ProgressBar bar;
    return run_scene(scene, {.folder = arguments.folder,
                             .threads = arguments.threads,
                             .resume = arguments.resume,
                             .fragments = arguments.fragments,
                             .progress = [&](const RunProgress& progress) { bar.show(progress); },
                             .interrupted = [] { return interrupt_asked != 0; }});
}

int run(const Arguments& arguments) {
    const RunResult result = simulate(arguments);
    const std::string folder = result.folder.string();
    if (result.status == RunStatus::completed) {
        fmt::print("completed {:.4g} s in {} steps, {:.3g} s of work; see {}/summary.json\n", result.time, result.steps,
                   result.wall_seconds, folder);
        return success;
    }
    if (result.status == RunStatus::interrupted)
        fmt::print(stderr, "phyxel: {}; go on with --resume {}/checkpoint.phyxel\n", result.message, folder);
    else fmt::print(stderr, "phyxel: the run failed at {:.6g} s: {}; see {}\n", result.time, result.message, folder);
    return failure;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
    auto* command = app.add_subcommand("run", "Simulates a scene, writes its outputs and summary.json");
    auto arguments = std::make_shared<Arguments>();
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

}  // namespace phyxel::cli
