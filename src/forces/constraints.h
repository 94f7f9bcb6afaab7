#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/hash.h"
#include "forces/selection.h"
#include "phyxel/body.h"

namespace phyxel {

/// Where a moving grip takes the points it holds: X -> R(t) (X - center) + center + d(t).
class GripMotion {
public:
    explicit GripMotion(const Fix& fix);
    Vec3 place(const Vec3& X, double time) const;
    bool moves() const { return path_.size() > 0; }
    void add_to(Hasher& hasher) const;

private:
    Vec3 axis_, center_;
    std::vector<GripKey> path_;
};

/// All fixes of a body. Each holds *rows*: a node of a node plane, or the average of a patch of surface in one cell,
/// sum_s A_s x_s / sum_s A_s = sum_i c_i x_i (one constraint a surface point instead would lock). Explicit steps
/// enforce them by projecting velocities in the metric of the masses,
///   v += M^-1 C^T lambda,  (C M^-1 C^T) lambda = target - C v,
/// which stores no energy and needs no stiffness. The projection is the same for x, y and z, apart from which fixes
/// hold.
class Constraints {
public:
    Constraints();
    ~Constraints();
    Constraints(Constraints&&) noexcept;
    Constraints& operator=(Constraints&&) noexcept;

    /// Adds a fix of `mesh`'s selected surface (rest space); returns its number.
    std::size_t add(const Model& model, const TriangleMesh& mesh, const Fix& fix, const Threads& threads);
    bool empty() const { return fixes_.empty(); }

    /// Changes `v` so that every row is where its grip takes it at `time` after a drift of `dt` from `x`; `dt` = 0: so
    /// that its velocity is the grip's. Adds the impulses [N s] to the fixes' totals, and to `impulse` [nodes]. Where
    /// mass damping leaves only a part of the impulse of a force in the velocities, `left` says which.
    void project(double time, double dt, std::span<const Vec3> x, std::span<Vec3> v, std::span<Vec3> impulse,
                 double left = 1);

    // --- implicit and static solvers: nodes of node planes are held directly, patch averages by the penalty
    // k/2 |sum c x - target|^2 with k = 1000 E A / a (the result does not depend on the factor from 100 to 1e7).

    /// [nodes] 1 for components that may move, 0 for held ones.
    std::vector<Vec3> free_components(std::size_t nodes) const;
    /// Puts the held components where their grips take them at `time`.
    void place_held(double time, std::span<Vec3> x) const;
    double penalty_energy(double time, std::span<const Vec3> x) const;
    void add_penalty_forces(double time, std::span<const Vec3> x, std::span<Vec3> f) const;
    /// Adds the derivative of the penalty forces' negative in the direction d.
    void add_penalty_action(std::span<const Vec3> d, std::span<Vec3> out) const;

    /// A patch average held by a penalty, for preconditioners.
    struct Patch {
        std::span<const std::uint32_t> node;
        std::span<const double> coefficient;  ///< sum 1
        Vec3 stiffness;                       ///< [N/m] in each direction; 0 where it may slide
    };
    std::vector<Patch> patches() const;

    /// Work of moving grips [J], through nodes that are held directly and through patches.
    struct GripWork {
        double nodes = 0, patches = 0;
    };
    /// Sets the next reactions: held components take the forces that balance `sum` [nodes], all other forces and
    /// inertia on the body; patches their penalty forces. Returns the work of these forces from `start` to `end` [s].
    GripWork measure(double start, double end, std::span<const Vec3> x, std::span<const Vec3> sum);

    /// Forgets the impulses; the next reactions are means from here on.
    void start_measuring();
    /// Mean force and torque on the body over `seconds` since `start_measuring`.
    Reaction reaction(std::size_t fix, double seconds) const;

    /// Adds what is held, in which directions and along which paths to a hash.
    void add_to(Hasher& hasher) const;

private:
    struct Row {
        std::uint32_t fix;
        std::vector<std::uint32_t> node;
        std::vector<double> coefficient;  ///< sum 1
        Vec3 rest;                        ///< rest place of the average
        double stiffness = 0;             ///< of the penalty [N/m]; 0: a node, held directly

        Vec3 average(std::span<const Vec3> x) const;
    };
    struct HeldFix {
        GripMotion motion;
        std::array<bool, 3> directions;
        Vec3 rest_center{};
        Vec3 force_impulse{}, torque_impulse{};
    };
    struct Factor;

    void factorize(const Model& model);
    /// What is missing to where the grip takes a row, in the directions that it holds.
    Vec3 missing(const Row& row, double time, std::span<const Vec3> x) const;
    void push(const Row& row, const Vec3& impulse, double time);

    std::vector<HeldFix> fixes_;
    std::vector<Row> rows_;
    std::array<std::unique_ptr<Factor>, 3> factors_;  ///< of C M^-1 C^T over the rows held in each direction
    std::vector<double> inverse_mass_;
};

}  // namespace phyxel
