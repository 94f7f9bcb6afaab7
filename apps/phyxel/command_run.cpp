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

RunResult simulate(const RunArguments& arguments) {
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

}  // namespace

int run(const RunArguments& arguments) {
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

}  // namespace phyxel::cli
