#pragma once

#include "base/threads.h"

namespace phyxel {

/// What tests run loops with that do not compare numbers of threads.
inline const Threads threads(2);

}  // namespace phyxel
