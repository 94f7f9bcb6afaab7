#pragma once

#include <string>
#include <vector>

#include "bench/benches.h"
#include "studies/studies.h"

/// The work of each command, one file each; command_line.cpp reads what the user typed. Every function returns the
/// exit code and throws `phyxel::Error` for what the user got wrong.

namespace phyxel::cli {

/// What the program returns to the shell.
enum ExitCode { success = 0, failure = 1, mistake = 2 };

struct RunArguments {
    std::string scene, folder, resume, fragments;
    std::vector<std::string> overrides;
    int threads = 0;
};
int run(const RunArguments& arguments);

struct CheckArguments {
    std::string mesh, part;
    bool as_json = false;
    int threads = 0;
};
int check(const CheckArguments& arguments);

/// All benchmarks where `name` is empty.
int run_benches(const std::string& name, const bench::Options& options);
std::string list_of_benches();

/// `name` may be "list".
int run_study(const std::string& name, studies::Options options);
std::string list_of_studies();

}  // namespace phyxel::cli
