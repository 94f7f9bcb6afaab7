#pragma once

#include <cstddef>
#include <optional>

#include "scene/scene.h"

namespace phyxel {

/// The times at which a run stops stepping: every frame, every time step that the scene asks for, and in between so
/// often that a run can be watched and interrupted. All follow from the scene alone, so that a resumed run meets the
/// same ones as a run that never stopped.
class Timeline {
public:
    /// `longest_piece`: [s] between two stops at most.
    Timeline(const SceneSimulation& simulation, double longest_piece);

    struct Stop {
        double time = 0;                   ///< [s]
        std::optional<std::size_t> frame;  ///< to be written then
    };

    /// The first stop after `now`.
    Stop next(double now) const;

    /// Number of the last frame, which is at the end of the run.
    std::size_t last_frame() const { return last_frame_; }
    double frame_time(std::size_t frame) const;
    /// The last frame at or before `now`.
    std::size_t frame_at(double now) const;

private:
    double duration_, frame_rate_, time_step_, longest_piece_;
    std::size_t last_frame_;
};

}  // namespace phyxel
