#pragma once

#include <span>
#include <vector>

#include "forces/cell_packing.h"

namespace phyxel {

struct CellOptions {
    /// Cells whose gradients times the spacing differ by less share them. The forces stay the exact derivative of the
    /// energy; with 1e-2 nearly all cells of a prism are uniform, which is good enough, and twice to six times faster,
    /// for a preconditioner.
    double tolerance = close_gradients;
    CellPoints points = CellPoints::all;
    Instructions instructions = best_instructions();
    /// [B] Up to so much, gradients stay in the cache, where reading them takes less time than adding differences: no
    /// chunk is similar then.
    std::size_t cached_gradients = 8'000'000;
};

/// Elastic forces, energy and stiffness at rest of one body in single precision, many lattice cells at a time.
///
/// All eight points of a lattice cell see the 4x4x4 nodes around it, so that cells side by side in the lanes of a
/// vector need no index a pair: the nodes of a cell's window are gathered once, the gradients are read in order, and
/// forces are summed over the window before they go back. Cells whose gradients are equal, deep in the body or along a
/// prism, share one set of them (*uniform* chunks). Where gradients are similar, the cells share a set and read what
/// each of them differs by in 16 bits (*similar* chunks: half of the memory, for bodies that the cache does not hold);
/// others, near a curved or turned surface, read their own (*mixed* chunks). Points of other lattices and
/// quadratures run the same way in small groups.
///
/// Positions are doubles; what the lanes see are displacements from the rest shape of a block of cells, moved rigidly
/// to where the block is, so that neither large coordinates nor rotations cost digits, and small strains keep theirs.
///
/// The same bits for any number of threads; not for any processor, since some fuse multiply and add. Calls share work
/// arrays: one at a time.
class CellBlocks {
public:
    CellBlocks(const Model& model, const Threads& threads, const CellOptions& options = {});

    /// Reads the moduli of the model again; its laws must be those of the construction.
    void set_materials(const Model& model, const Threads& threads);

    /// f = -dU/dx [N], U the elastic energy, without stabilization; returns U [J].
    double forces(const Model& model, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) const;

    /// The same with the viscous forces of `internal_forces` at the velocities v [m/s], beta > 0 [s].
    double damped_forces(const Model& model, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                         const Threads& threads, std::span<Vec3> f) const;

    /// U [J].
    double energy(const Model& model, std::span<const Vec3> x, const Threads& threads) const;

    /// K d [N], K the elastic stiffness at rest: linear elasticity, dP = 2 mu sym(dF) + lambda tr(dF) I.
    void rest_action(const Model& model, std::span<const Vec3f> d, const Threads& threads, std::span<Vec3f> out) const;

    /// False where more points share one dilatation than there is room for in the lanes, eight a lane: the parts of
    /// such a cell average by themselves then, which is not quite the body that the double-precision forces see.
    bool matches_model() const { return matches_model_; }

    /// What is done in one evaluation.
    struct Counts {
        std::size_t groups = 0, chunks = 0, uniform_chunks = 0, similar_chunks = 0;
        std::size_t pairs = 0;       ///< of points and nodes, those of empty lanes not counted
        std::size_t lane_pairs = 0;  ///< with all that the lanes compute in vain
        std::size_t bytes = 0;       ///< of gradients and indices
    };
    const Counts& counts() const { return counts_; }

private:
    void number_slots(std::size_t nodes);
    void count(const Model& model);
    void fill_moduli(const Model& model, const CellGroups::Group& group, CellBlock& block, std::size_t chunk,
                     std::size_t lane) const;
    void join_lanes(CellBlock& block, std::size_t chunk) const;
    Mat3 move_to_slots(const Model& model, std::size_t block, std::span<const Vec3> x) const;
    void rates_to_slots(std::size_t block, const Mat3& R, std::span<const Vec3> v, double beta) const;
    double run(std::size_t block, CellTask task) const;
    double find_forces(const Model& model, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                       const Threads& threads, std::span<Vec3> f) const;

    CellGroups groups_;
    std::size_t lanes_;
    CellKernel kernel_;
    CellPoints points_;
    double length_ = 1, stiffness_ = 1;  ///< units of the lanes: spacing [m], largest V times modulus [J]
    CellShapes shapes_;
    std::vector<CellBlock> blocks_;
    std::vector<std::uint32_t> slot_begin_;        ///< [blocks + 1]
    std::vector<std::uint32_t> node_slot_offset_;  ///< [nodes + 1] into `node_slots_`
    std::vector<std::uint32_t> node_slots_;
    std::size_t largest_window_ = 0;
    bool matches_model_ = true;
    Counts counts_;
    mutable std::vector<Float4> u_, f_;  ///< [slots]
    mutable std::vector<Float4> rate_;   ///< [slots] once forces were damped
};

}  // namespace phyxel
