#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/build_world.h"

namespace phyxel {

/// What a run did, beside what its world tells.
struct RunRecord {
    std::string status;   ///< "completed", "interrupted", "failed"
    std::string message;  ///< why; empty when completed
    int threads = 1;
    double resumed_from = 0;  ///< [s] of simulated time; 0: from the start
    std::size_t steps = 0, retries = 0, frames = 0;
    double smallest_step = 0;  ///< [s]
    std::size_t newton_iterations = 0, newton_worst = 0, linear_iterations = 0, linear_worst = 0;
    double wall_seconds = 0, setup_seconds = 0;
};

/// `summary.json` as text: every key of the contract, in its order.
std::string summary_json(const Scene& scene, const BuiltScene& built, const RunRecord& record);

}  // namespace phyxel
