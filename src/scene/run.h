#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "scene/scene.h"

namespace phyxel {

/// How far a run is.
struct RunProgress {
    double time = 0, start = 0, duration = 0;  ///< [s] simulated: now, at the beginning of this run, at its end
    std::size_t steps = 0;                     ///< taken by this run
    double wall_seconds = 0;                   ///< since the first step
};

struct RunOptions {
    std::filesystem::path folder;     ///< of the output; empty: output/SCENE
    int threads = 0;                  ///< 0: all of the machine's
    std::filesystem::path resume;     ///< a checkpoint to go on from; empty: from the start
    std::filesystem::path fragments;  ///< where to write each fragment of the last frame; empty: nowhere
    std::function<void(const RunProgress&)> progress;  ///< called now and then
    std::function<bool()> interrupted;                 ///< asked now and then; true ends the run
};

enum class RunStatus { completed, interrupted, failed };

struct RunResult {
    RunStatus status = RunStatus::completed;
    std::string message;  ///< why it ended early; empty when completed
    std::filesystem::path folder;
    double time = 0;          ///< [s] simulated
    std::size_t steps = 0;    ///< taken by this run
    double wall_seconds = 0;  ///< of stepping and writing
};

/// Simulates a scene and writes its outputs; what they are is in docs/scene.md. Throws `Error` for whatever is wrong
/// before the first step; from then on every end, a full disk included, is a `RunResult` and leaves a summary.
RunResult run_scene(const Scene& scene, const RunOptions& options = {});

}  // namespace phyxel
