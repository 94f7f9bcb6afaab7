#pragma once

#include <memory>
#include <optional>
#include <string>

#include "contact/body_contact.h"
#include "forces/constraints.h"
#include "forces/fast_forces.h"
#include "forces/internal_forces.h"
#include "forces/loads.h"
#include "solver/stable_step.h"
#include "solver/warped_preconditioner.h"
#include "surface/embedded_surface.h"

namespace phyxel {

/// What acts on every body of a world.
struct Surroundings {
    Vec3 gravity{};
    double mass_damping = 0;       ///< [1/s]
    double stiffness_damping = 0;  ///< [s]
    std::vector<Collider> colliders{};
    SolverSettings solver{};
};

/// Amounts of energy [J] that left or entered a body since the start.
struct Exchanged {
    double external = 0, damping = 0, friction = 0;
    double numerical = 0;  ///< by implicit integrators themselves
};

/// Where a body was one step ago, for integrators of two steps.
struct History {
    std::vector<Vec3> x, v;  ///< [nodes]
    double dt = 0;           ///< [s] length of the last step; 0: there was none
    double trend = 0;        ///< share of the last change of velocity that the next step starts from
};

/// A body in motion: what it is, where it is, and what acts on it.
struct DynamicBody {
    std::string name;   ///< for messages; may be empty
    TriangleMesh mesh;  ///< the surface as simulated, rest space
    Model model;
    State state;
    std::optional<EmbeddedSurface> surface;
    Constraints constraints;
    std::vector<SurfaceLoad> loads;
    std::optional<ContactSamples> contact;  ///< made when there is something to touch
    bool separate_contact_surface = false;  ///< another one than that of its mesh
    Exchanged exchanged;
    LargestFrequency frequency;
    double rest_step = 0;   ///< [s] stable step of the body at rest
    double step_limit = 0;  ///< [s] stable step of the body as it is now

    // Implicit and static.
    History history;
    double carried_load = 0;                    ///< share of the loads that the state is in equilibrium with
    std::vector<ContactSamples::Stick> sticks;  ///< where samples stick to obstacles
    double penalty_energy = 0;                  ///< [J] of patches held by penalties
    double friction = 0.5;                      ///< against other bodies
    std::vector<std::uint32_t> apart;           ///< numbers of bodies that it does not meet, ascending
    std::vector<BodyStick> body_sticks;         ///< what friction with other bodies holds
    double body_contact_energy = 0;             ///< [J] of its samples inside of other bodies
    std::size_t body_touches = 0;               ///< how many there are
    std::optional<double> step_energy;          ///< [J] kinetic and stored, after an implicit step
    std::unique_ptr<FastForces> fast_forces;
    /// What the preconditioner of a nearly incompressible body works with: the same body, more compressible. Coarse
    /// lattices have no fields that keep the volume of every cell and would lock.
    std::unique_ptr<Model> softened;
    std::unique_ptr<WarpedPreconditioner> preconditioner;  ///< made when first needed, for its material and fixes

    /// Single-precision forces, made when first needed; null when the model's quadrature has none.
    FastForces* prepare_fast_forces(const Threads& threads);
    /// The preconditioner of s K + c M + penalties, made or brought up to date.
    WarpedPreconditioner& prepare_preconditioner(double stiffness, double inertia, const Threads& threads);
    /// To be called when the material or the fixes change, or the motion starts anew.
    void forget_solver() {
        preconditioner.reset(), softened.reset(), fast_forces.reset(), history = {}, step_energy.reset();
    }

    // Work arrays [nodes].
    ForceWorkspace work;
    std::vector<Vec3> force;                      ///< all forces but the constraints' [N]
    std::vector<Vec3> load_force;                 ///< the loads' part of them [N]
    std::vector<ContactSamples::Touch> touches;   ///< samples inside of an obstacle
    std::vector<ContactSamples::Rub> rubs;        ///< friction of the implicit step that is being taken
    std::vector<Vec3> impulse, friction_impulse;  ///< of the constraints and of friction [N s]
    std::vector<Vec3> previous;                   ///< velocity before a kick [m/s]
    double viscous_power = 0;                     ///< [W]
};

/// What messages call a body: `body "bunny"`, or `body 3` for one without a name that has that number in its world.
std::string name_of(const DynamicBody& body, std::size_t number);

/// Evaluates the forces at the body's positions and velocities.
void evaluate_forces(DynamicBody& body, const Surroundings& around, double time, const Threads& threads);

/// v += dt f/m with exact mass damping exp(-alpha dt), then friction, then the fixes: `drift` is how far positions will
/// go with the new velocity, up to `time`; 0 when they stay. Books the work done.
void kick(DynamicBody& body, const Surroundings& around, double dt, double drift, double time, const Threads& threads);

/// x += dt v.
void drift(DynamicBody& body, double dt, const Threads& threads);

/// sum m |v|^2 / 2 [J].
double kinetic_energy(const DynamicBody& body, const Threads& threads);

}  // namespace phyxel
