#pragma once

#include <CLI/CLI.hpp>

/// The commands of the program, one file each. Every function adds its command to `app`; when the command was given,
/// its work is done in the callback, which leaves the exit code in `exit_code` and throws `phyxel::Error` for what the
/// user got wrong.

namespace phyxel::cli {

/// What the program returns to the shell.
enum ExitCode { success = 0, failure = 1, mistake = 2 };

void add_run(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_study(CLI::App& app, int& exit_code);

/// The option `--threads N` that every command has.
void add_threads(CLI::App& command, int& threads);

}  // namespace phyxel::cli
