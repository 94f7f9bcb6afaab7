#include "forces/cell_kernel.h"

#include "base/polar.h"

#include "forces/cell_kernel_body.h"

namespace phyxel {

double cell_kernel_plain(std::span<const CellChunk> chunks, CellTask task, const CellSlots& slots) {
    return CellKernelBody<PlainLanes<EightFloats>>::run(chunks, task, slots);
}

}  // namespace phyxel
