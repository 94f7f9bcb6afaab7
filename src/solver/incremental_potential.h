#pragma once

#include <span>
#include <vector>

#include "solver/dynamic_body.h"

namespace phyxel {

/// What an implicit step minimizes over the node positions x at the end of the step, and a static solve without the
/// first term:
///     c/2 |x - target|^2_M + Psi(x) + penalties(x) + contact(x) + friction(x) - loads . x
/// Held components of x do not vary. Damping and pressure loads are no potentials; their forces count in the gradient.
class IncrementalPotential {
public:
    IncrementalPotential(DynamicBody& body, const Surroundings& around, SolverPrecision precision,
                         const Threads& threads);

    /// Inertia: c = a0 (a0/dt + alpha)/dt for velocities v = (a0 x - past)/dt (solver/implicit_step.cpp).
    double inertia = 0;                 ///< c [1/s^2]; 0 in statics
    std::vector<Vec3> target;           ///< [nodes]
    double velocity_share = 0;          ///< dv/dx = a0/dt [1/s]; 0 in statics
    std::vector<Vec3> velocity_offset;  ///< [nodes] v = velocity_share x - offset
    double time = 0;                    ///< at the end of the step: where grips are
    double load_time = 0;               ///< how far loads are ramped up
    double load_share = 1;              ///< of gravity and loads, for load steps
    std::vector<Vec3> start;            ///< [nodes] x at the beginning of the step, which new slip counts from

    /// Takes the normal forces at x for friction to work with until the next call; statics have none.
    void lag_friction(std::span<const Vec3> x);

    /// Stiffness of contact and sticking friction at x, lumped to the nodes [N/m]; empty without any.
    std::vector<Mat3> supports(std::span<const Vec3> x);

    /// Writes the derivative by x; held components are 0.
    void gradient(std::span<const Vec3> x, std::span<Vec3> g);
    /// Writes the second derivative at x applied to d, held components 0.
    void action(std::span<const Vec3> x, std::span<const Vec3> d, std::span<Vec3> out);

    /// Adds the part of the action that contact with obstacles and its friction have.
    void add_contact_action(std::span<const Vec3> x, std::span<const Vec3> d, std::span<Vec3> out) const;
    /// a += s f in the components that are not held.
    void add_free(double s, std::span<const Vec3> f, std::span<Vec3> a) const;

    /// The forces at x, sorted by where their work goes.
    struct Forces {
        std::vector<Vec3> conservative;  ///< elastic, stabilization, contact, penalties
        std::vector<Vec3> viscous, friction, loads;
        std::vector<Vec3> sum;  ///< all of these, gravity and inertia: what held components must balance
        double stored = 0;      ///< elastic and stabilization energy [J], in the precision of the forces
    };
    Forces forces(std::span<const Vec3> x);

    std::size_t size() const { return free_.size(); }
    /// Norm of all forces that act from outside, for tolerances [N]: gravity and loads.
    double external_force(std::span<const Vec3> x);

    DynamicBody& body;
    const Surroundings& around;
    const Threads& threads;

private:
    double stiffness_damping() const { return velocity_share > 0 ? around.stiffness_damping : 0; }
    /// Writes elastic, stabilization and viscous forces.
    void damped_forces(std::span<const Vec3> x, std::span<Vec3> f);
    /// f += contact, and friction into `friction`.
    void add_contact(std::span<const Vec3> x, std::span<Vec3> f, std::span<Vec3> friction);

    FastForces* fast_;  ///< null: in double
    std::vector<Vec3> free_, velocity_, loads_;
};

/// Makes the contact of a body as stiff as an implicit step over `dt` [s] or, where that is softer, its material asks
/// for: 10 / (tau^2 w), tau the step or the time that a wave takes over a spacing.
void set_contact_stiffness(DynamicBody& body, double dt);

}  // namespace phyxel
