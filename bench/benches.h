#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>

namespace phyxel::bench {

struct Options {
    int threads = 0;       ///< 0: all of the machine's
    bool as_json = false;  ///< one JSON value on standard output instead of a table
    std::string mesh;  ///< set-up: mesh file; empty: the bunny of `scenes/` (a sphere where that is missing), quartered
    std::size_t nodes = 0;   ///< set-up, cantilever, solver: this number of nodes only; 0: those of their tables
    bool large = false;      ///< set-up: 200,000 nodes as well
    bool reference = false;  ///< table 5.1: also time the listing of the thesis, coded literally; cantilever: also
                             ///< finite elements
};

/// Steps per second on the seven bodies of table 5.1 of the 2008 thesis; returns the program's exit code.
int run_table_5_1(const Options& options);

/// A heavy and a stiff cantilever: error, motion, time and memory of implicit steps.
int run_cantilever(const Options& options);

/// Time from a mesh file to the first step, stage by stage, and peak memory.
int run_setup(const Options& options);

/// Time of the single-precision forces, energy and stiffness at rest, beside double precision and the core's peak; one
/// thread unless told otherwise.
int run_kernel(const Options& options);

/// Iterations and time of the linear systems of implicit steps with multigrid and with block Jacobi; one thread unless
/// told otherwise.
int run_solver(const Options& options);

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Shortest time [s] of `repetitions` calls: what the machine can do when nothing else interrupts.
template <class Work>
double shortest(int repetitions, Work&& work) {
    double best = 1e300;
    for (int r = 0; r < repetitions; ++r) {
        const Clock::time_point start = Clock::now();
        work();
        best = std::min(best, seconds_since(start));
    }
    return best;
}

}  // namespace phyxel::bench
