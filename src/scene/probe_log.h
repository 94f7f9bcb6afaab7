#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/build_world.h"

namespace phyxel {

/// `probes.csv`: the time, then the position of each probe, one row a frame. Each row is handed to the system as it
/// comes, so that a killed run keeps all but the last.
class ProbeLog {
public:
    /// Starts the file; with `resume_time` [s] keeps the rows up to it of a file that is there already.
    ProbeLog(std::filesystem::path path, const Scene& scene, double resume_time);

    void add_row(const BuiltScene& built);

private:
    std::filesystem::path path_;
    std::ofstream file_;
};

}  // namespace phyxel
