#pragma once

namespace phyxel::cli {

/// Reads the arguments, does what they ask for, and returns the exit code. Throws `phyxel::Error` for what the user got
/// wrong in anything but the arguments.
int run_command_line(int argc, char** argv);

}  // namespace phyxel::cli
