#pragma once

#include <filesystem>

/// Published experiments, one file each. Every study prints a table, writes it as NAME.csv with a picture NAME.png, and
/// ends with claims that it checks; its return value is the program's exit code, 1 when a claim failed.

namespace phyxel::studies {

struct Options {
    std::filesystem::path folder;  ///< for the table and the picture
    bool small = false;            ///< a few seconds instead of a minute or two
    int threads = 0;               ///< 0: all of the machine's
};

int run_accuracy(const Options& options);
int run_convergence(const Options& options);
int run_locking(const Options& options);
int run_ghost_forces(const Options& options);
int run_rotation(const Options& options);
int run_timing(const Options& options);
int run_two_materials(const Options& options);
int run_irregular_steps(const Options& options);
int run_nodal_integration(const Options& options);
int run_support(const Options& options);
int run_torus_on_floor(const Options& options);
int run_pile(const Options& options);

}  // namespace phyxel::studies
