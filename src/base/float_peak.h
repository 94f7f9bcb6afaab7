#pragma once

#include "base/float_lanes.h"

namespace phyxel {

/// Runs `rounds` of ten independent multiply-adds of a whole vector, as fast as the processor can; returns the floating
/// point operations done. For measuring the peak of a core.
double run_float_peak(Instructions instructions, std::size_t rounds);

}  // namespace phyxel
