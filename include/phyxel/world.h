#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "phyxel/body.h"
#include "phyxel/mesh.h"
#include "phyxel/solver.h"

namespace phyxel {

enum class Integrator {
    leap_frog,       ///< explicit: velocities at half steps; the thesis' choice (Stegmayr 2008)
    verlet,          ///< explicit: velocity Verlet; the same trajectory, velocities at whole steps
    implicit_euler,  ///< the nonlinear backward Euler step: any step holds, motion is damped by the integrator; default
    bdf2,            ///< second order in the step, damps far less
    statics,         ///< equilibrium with the loads and grips at the end of the step; no motion
};

/// Whether an integrator's steps must stay below a bound that stiffness and spacing set.
constexpr bool is_explicit(Integrator integrator) {
    return integrator == Integrator::leap_frog || integrator == Integrator::verlet;
}

/// Runs `task(0) ... task(count - 1)`, in any order and on any threads, and returns when all are done.
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

struct WorldSettings {
    double time_step =
        1.0 / 60;  ///< what `step()` advances [s]; explicit integrators divide it evenly into stable substeps
    Vec3 gravity{0, -9.81, 0};  ///< [m/s^2]
    Integrator integrator = Integrator::implicit_euler;
    double mass_damping = 0;  ///< Rayleigh alpha [1/s]; raising it slows all motion, falling included
    double stiffness_damping =
        0;                    ///< Rayleigh beta [s], on the rate of strain; raising it quiets vibration, shortens steps
    SolverSettings solver{};  ///< of implicit steps and equilibria
    int threads = 0;          ///< 0: all of the machine's; results do not depend on it
    ParallelFor parallel_for{};  ///< the caller's own task system; empty: a pool of `threads`
};

/// Energies of all bodies in the world [J]. Dissipated and external amounts are totals since each body was added.
struct EnergyLedger {
    double kinetic = 0, elastic = 0, stabilization = 0, constraint = 0, gravitational = 0;
    double plastic = 0, fracture = 0, contact = 0, friction = 0, damping = 0;
    double external_work = 0;  ///< by loads and moving grips
    double numerical = 0;      ///< what the integrator itself dissipated, from its own formula
    double balance_error = 0;  ///< what is left over, relative to the largest total seen
};

/// A condition that was met while setting up or stepping, with how often.
struct Warning {
    std::string message;
    std::size_t count = 0;
};

enum class StepStatus {
    ok,
    failed,  ///< no stable step was found: the state is the last good one, `message` says what happened where
};

/// What a step did.
struct StepReport {
    StepStatus status = StepStatus::ok;
    std::string message;
    double advanced = 0;                                  ///< simulated seconds
    std::size_t substeps = 0;                             ///< steps of the integrator
    std::size_t retries = 0;                              ///< times a step was thrown away and cut into smaller ones
    double substep = 0;                                   ///< the last one [s]
    std::size_t contacts = 0;                             ///< surface samples touching a collider at the end
    std::size_t newton_iterations = 0, newton_worst = 0;  ///< of Newton's method and L-BFGS, all and in one solve
    std::size_t linear_iterations = 0, linear_worst = 0;  ///< of conjugate gradients, all and in one Newton iteration
};

/// Counts and sizes of one body.
struct BodyReport {
    std::size_t nodes = 0, quadrature_points = 0;
    double mean_neighbors = 0;  ///< nodes in a quadrature point's stencil
    double spacing = 0;         ///< [m]
    double mass = 0;            ///< [kg] density times mesh volume
    double rest_volume = 0;     ///< [m^3] sum of V_q
    double mesh_volume = 0;     ///< [m^3] of the region whose winding number is above 1/2
    double volume = 0;          ///< [m^3] current, sum of J V_q
    Vec3 center_of_mass{};      ///< [m] current
    std::size_t fragments = 1;
};

/// Where a probe is now.
struct ProbeReading {
    Vec3 rest, position;
};

/// The surface mesh of a body, following its nodes. Spans stay valid until the body is removed; their content changes
/// with each step.
class Surface {
public:
    virtual std::span<const Vec3f> positions() const = 0;  ///< [vertices] current [m]
    virtual std::span<const Vec3f> normals() const = 0;    ///< [vertices] current, unit: cof(F) N
    virtual std::span<const Triangle> triangles() const = 0;

protected:
    ~Surface() = default;
};

/// Stress and strain at the quadrature points of a body, computed when asked for.
struct PointFields {
    std::vector<Vec3> positions;             ///< [points] current [m]
    std::vector<double> volumes;             ///< [points] rest V_q [m^3]
    std::vector<Mat3> deformation_gradient;  ///< [points] F
    std::vector<Mat3> cauchy_stress;         ///< [points] P F^T / J [Pa]
    std::vector<double> von_mises;           ///< [points] [Pa]
    std::vector<Vec3> principal_stress;      ///< [points] [Pa], largest first
    std::vector<double> energy_density;      ///< [points] per rest volume [J/m^3]
};

/// Soft bodies, colliders, fixes and loads, and the time they are at. Two worlds share nothing. Not to be used from two
/// threads at once. Functions that add something throw `Error` on a wrong setting; stepping never throws.
class World {
public:
    explicit World(const WorldSettings& settings = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    // --- making things
    BodyId add_body(const TriangleMesh& mesh, const BodySettings& settings);
    void remove_body(BodyId body);
    std::size_t add_collider(const Plane& plane);
    std::size_t add_collider(const Sphere& sphere);
    std::size_t add_collider(const Box& box);
    std::size_t add_fix(BodyId body, const Fix& fix);
    std::size_t add_load(BodyId body, const Load& load);
    std::size_t add_probe(BodyId body, const Vec3& rest_point);

    // --- advancing
    StepReport step();                   ///< by `WorldSettings::time_step`
    StepReport advance(double seconds);  ///< by as many steps as needed
    void set_gravity(const Vec3& gravity);
    void set_velocity(BodyId body, const Vec3& velocity);
    /// Changes the body's own material, or that of its region number `region` (from 0); same density.
    void set_material(BodyId body, const Material& material, std::optional<std::size_t> region = {});

    // --- reading
    double time() const;            ///< [s]
    double stable_substep() const;  ///< [s] of all bodies together; implicit and static worlds: `time_step`
    std::span<const Vec3> rest_positions(BodyId body) const;  ///< [nodes] [m]
    std::span<const Vec3> positions(BodyId body) const;       ///< [nodes] [m]
    std::span<const Vec3> velocities(BodyId body) const;      ///< [nodes] [m/s]
    std::span<const double> masses(BodyId body) const;        ///< [nodes] [kg]
    const Surface& surface(BodyId body) const;
    PointFields point_fields(BodyId body) const;
    std::vector<float> surface_von_mises(BodyId body) const;  ///< [vertices] [Pa], for colouring
    BodyReport report(BodyId body) const;
    const MeshReport& mesh_report(BodyId body) const;
    Reaction reaction(std::size_t fix) const;
    ProbeReading probe(std::size_t probe) const;
    EnergyLedger energy() const;
    std::vector<Warning> warnings() const;
    std::uint64_t state_hash() const;  ///< of all positions, velocities and the time, bit by bit

    // --- keeping
    void save_checkpoint(const std::filesystem::path& path) const;
    /// Restores a state saved from a world with the same bodies. Throws `Error` when the file is damaged or of another
    /// world.
    void load_checkpoint(const std::filesystem::path& path);

    struct Parts;  ///< internal
    Parts& parts() { return *parts_; }
    const Parts& parts() const { return *parts_; }

private:
    std::unique_ptr<Parts> parts_;
};

}  // namespace phyxel
