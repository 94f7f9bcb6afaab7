#include "scene/timeline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phyxel {
namespace {

/// Part of an interval within which two times are the same: far above rounding, far below any step.
constexpr double same = 1e-6;

}  // namespace

Timeline::Timeline(const SceneSimulation& simulation, double longest_piece)
    : duration_(simulation.duration),
      frame_rate_(simulation.frame_rate),
      time_step_(simulation.time_step.value_or(std::numeric_limits<double>::infinity())),
      longest_piece_(longest_piece),
      last_frame_(static_cast<std::size_t>(std::max(1.0, std::ceil(duration_ * frame_rate_ - same)))) {}

double Timeline::frame_time(std::size_t frame) const {
    return frame >= last_frame_ ? duration_ : static_cast<double>(frame) / frame_rate_;
}

std::size_t Timeline::frame_at(double now) const {
    if (now >= duration_ * (1 - 1e-12)) return last_frame_;
    return std::min(last_frame_ - 1, static_cast<std::size_t>(now * frame_rate_ + same));
}

Timeline::Stop Timeline::next(double now) const {
    // The frame and the time step on either side; times closer than `same` are one
    const std::size_t frame = frame_at(now);
    const double steps = std::isfinite(time_step_) ? std::floor(now / time_step_ + same) : 0;
    double before = frame_time(frame), after = frame_time(frame + 1);
    bool is_frame = true;
    if (std::isfinite(time_step_)) {
        before = std::max(before, steps * time_step_);
        const double step = (steps + 1) * time_step_;
        if (step < after - same * std::min(time_step_, 1 / frame_rate_)) after = step, is_frame = false;
    }

    // Even pieces in between
    const double pieces = std::max(1.0, std::ceil((after - before) / longest_piece_ - same));
    const double piece = std::floor((now - before) / (after - before) * pieces + same) + 1;
    if (piece < pieces) return {before + (after - before) * piece / pieces, std::nullopt};
    return {after, is_frame ? std::optional(frame + 1) : std::nullopt};
}

}  // namespace phyxel
