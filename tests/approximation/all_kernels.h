#pragma once

#include "approximation/kernel.h"

namespace phyxel {

inline constexpr KernelShape all_kernels[] = {KernelShape::quartic_spline, KernelShape::poly6,
                                              KernelShape::cubic_spline, KernelShape::wendland};

}  // namespace phyxel
