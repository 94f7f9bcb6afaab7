#pragma once

#include "approximation/stencils.h"

namespace phyxel {

/// [nodes] sum_q w_qi/(sum_j w_qj) value_q: what the points hold, shared out to the nodes in their supports. The total
/// is kept.
std::vector<double> shepard_sums(const Sampling& sampling, const ApproximationSettings& settings,
                                 const Stencils& stencils, std::span<const double> value, const Threads& threads);

}  // namespace phyxel
