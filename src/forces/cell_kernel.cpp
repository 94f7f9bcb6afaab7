#include "forces/cell_kernel.h"

namespace phyxel {

std::size_t cell_lanes(Instructions instructions) { return instructions == Instructions::avx512 ? 16 : 8; }

CellKernel cell_kernel(Instructions instructions) {
#if defined(__x86_64__)
    if (instructions == Instructions::avx512) return cell_kernel_avx512;
    if (instructions == Instructions::avx2) return cell_kernel_avx2;
#endif
    return cell_kernel_plain;
}

}  // namespace phyxel
