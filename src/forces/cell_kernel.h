#pragma once

#include <array>
#include <span>

#include "base/float_lanes.h"
#include "phyxel/material.h"

namespace phyxel {

/// What the lanes of a chunk have for gradients.
enum class ChunkKind : std::uint8_t {
    uniform,  ///< one gradient for all lanes
    similar,  ///< that and a small difference for each lane, in 16 bits
    mixed,    ///< a gradient for each lane
};

/// Gradients times the spacing are written in this: for similar chunks in the unit of their differences, which thus
/// cost an addition, no product.
constexpr float gradient_unit(ChunkKind kind) { return kind == ChunkKind::similar ? 6.2e-8f : 1; }

/// Eight or sixteen groups of points side by side, one a lane, and all that is needed to go from the displacements of
/// the nodes in their windows to the forces on them.
struct CellChunk {
    const std::uint16_t* slot;       ///< [entries][lanes] slot of a window's node in the block
    const std::uint16_t* entry;      ///< [pairs] entries that the points see, one point after another
    const float* gradient;           ///< [pairs][3], mixed: [pairs][3][lanes], times the spacing over their unit
    const std::int16_t* difference;  ///< [pairs][3][lanes], likewise; null where not similar
    const float* lame;               ///< [8][2][lanes] V lambda and V mu, over the unit of stiffness
    const float* volume_stiffness;   ///< [8][lanes] V k_v, likewise; null where there is none
    const float* share;        ///< [8][lanes] V over that of the points that share a dilatation; null where none do
    const std::uint8_t* join;  ///< [lanes] the first lane with the same dilatation; null where all have their own
    std::array<std::uint32_t, 9> pair_begin;  ///< of each point, and the end
    std::uint32_t entries;
    ChunkKind kind;
    Law law;
};

enum class CellTask {
    forces,         ///< adds those of the chunks' points to the slots, and finds the energy
    damped_forces,  ///< the same with the viscous forces of the rates
    energy,         ///< the energy alone
    rest_action,    ///< adds the stiffness at rest times the displacements, whatever the law: Hooke's
};

/// What the kernel works on: the slots of a block.
struct CellSlots {
    const Float4* u;     ///< displacements, in spacings
    const Float4* rate;  ///< beta v of damped forces, likewise
    Float4* f;           ///< forces
    float* scratch;      ///< twice [largest number of entries][3][lanes]
};

/// Does `task` for the chunks of a block; returns the energy if that is asked for.
using CellKernel = double (*)(std::span<const CellChunk> chunks, CellTask task, const CellSlots& slots);

/// Lanes a chunk has for some instructions.
std::size_t cell_lanes(Instructions instructions);

CellKernel cell_kernel(Instructions instructions);

/// One for each set of instructions; sixteen lanes without special instructions are for tests.
double cell_kernel_plain(std::span<const CellChunk>, CellTask, const CellSlots&);
double cell_kernel_avx2(std::span<const CellChunk>, CellTask, const CellSlots&);
double cell_kernel_avx512(std::span<const CellChunk>, CellTask, const CellSlots&);

}  // namespace phyxel
