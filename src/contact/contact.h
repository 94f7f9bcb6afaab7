#pragma once

#include <span>
#include <vector>

#include "approximation/embedded_points.h"
#include "contact/collider.h"
#include "model/model.h"

namespace phyxel {

/// Points of a body's surface that meet obstacles: the mesh's vertices, and, where triangles are larger than half a
/// spacing, points on their edges and inside of them.
///
/// Each sample inside an obstacle stores k/2 d^2, d its signed distance, and is slowed by Coulomb friction,
/// -mu f_n v_t / max(|v_t|, eps_v). (A contact that began at a distance would throw up a body placed exactly on a
/// floor.) The stiffness is as large as explicit steps allow, k_s = beta / (dt^2 w_s), where w_s >= the inverse mass
/// that the sample and all others on the same nodes see together (row bound of C^T M^-1 C), beta = 0.5 and dt the
/// body's stable step at rest, so that the energy is one and the same for the whole run.
class ContactSamples {
public:
    ContactSamples(const Model& model, const TriangleMesh& mesh, double stable_step, const Threads& threads);

    /// Adds contact and friction forces of all obstacles to `f`, and the friction forces alone to `friction`; returns
    /// the number of samples that touch. `dt` is the length of the coming step, which limits friction.
    std::size_t add_forces(std::span<const Collider> colliders, std::span<const Vec3> x, std::span<const Vec3> v,
                           double dt, const Threads& threads, std::span<Vec3> f, std::span<Vec3> friction) const;

    /// How deep [m] the deepest sample is inside of an obstacle; 0 when none is.
    double deepest(std::span<const Collider> colliders, std::span<const Vec3> x, const Threads& threads) const;

    /// Stored energy [J].
    double energy(std::span<const Collider> colliders, std::span<const Vec3> x, const Threads& threads) const;

private:
    struct Touch {
        std::uint32_t sample, collider;
        double depth;  ///< -d > 0 [m]
        Vec3 normal;
    };
    std::vector<Touch> touches(std::span<const Collider> colliders, std::span<const Vec3> x,
                               const Threads& threads) const;

    EmbeddedPoints samples_;
    std::vector<double> inverse_mass_;  ///< [samples] w_s [1/kg]
    double step_squared_ = 0;           ///< dt^2 of the stiffness [s^2]
};

}  // namespace phyxel
