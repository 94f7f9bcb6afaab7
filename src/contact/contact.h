#pragma once

#include <span>
#include <vector>

#include "approximation/embedded_points.h"
#include "contact/collider.h"
#include "contact/contact_surface.h"
#include "contact/friction_spring.h"
#include "contact/moving_surface.h"
#include "model/model.h"

namespace phyxel {

/// Points of a body that meet obstacles: the vertices of its contact surface.
///
/// Each sample inside an obstacle stores k/2 d^2, d its signed distance. (A contact that began at a distance would
/// throw up a body placed exactly on a floor.) The stiffness is as large as explicit steps allow, k_s = beta / (dt^2
/// w_s), where w_s >= the inverse mass that the sample and all others on the same nodes see together (row bound of C^T
/// M^-1 C), beta = 0.5 and dt the body's stable step at rest, so that the energy is one and the same for the whole run.
///
/// Coulomb friction acts on the velocities that all other forces lead to: an impulse at each touching sample,
/// tangential and at most mu f_n dt, that stops its slip or opposes it. (A force -mu f_n v_t / max(|v_t|, eps_v) of the
/// old velocities cannot hold a body: stable steps limit it to what stops the lowest layer of nodes alone, and a block
/// of two layers on a slope below the friction angle crept at 4 cm/s.)
class ContactSamples {
public:
    static constexpr double explicit_share = 0.5;  ///< beta; the bound is 4, less what elasticity takes

    ContactSamples(const Model& model, const ContactSurface& surface, double stable_step, const Threads& threads);

    /// A sample inside of an obstacle.
    struct Touch {
        std::uint32_t sample, collider;
        double depth;  ///< -d > 0 [m]
        double push;   ///< normal force f_n [N]
        Vec3 normal;
    };

    /// Adds the contact forces of all obstacles, friction not among them, to `f`; returns the samples that touch.
    std::vector<Touch> add_forces(std::span<const Collider> colliders, std::span<const Vec3> x, const Threads& threads,
                                  std::span<Vec3> f) const;

    /// Changes `v` by the friction of `touches` during `dt` [s], and adds its impulses [N s] to `impulse` [nodes].
    void add_friction(std::span<const Collider> colliders, std::span<const Touch> touches, double dt, std::span<Vec3> v,
                      std::span<Vec3> impulse) const;

    /// Changes the stiffness of the samples to k_s = share / (step^2 w_s).
    void set_stiffness(double share, double step) { stiffness_share_ = share, step_squared_ = step * step; }

    // --- implicit and static solvers

    /// Adds the second derivative of the contact energy applied to `d`, k n n^T of each of `touches` (the curvature of
    /// obstacles is left out, so that it is never negative).
    void add_action(std::span<const Touch> touches, std::span<const Vec3> d, std::span<Vec3> out) const;

    /// Where on an obstacle a sample sticks.
    struct Stick {
        std::uint32_t sample, collider;
        Vec3 anchor;  ///< [m]
    };
    /// Friction of a touching sample with a normal force that is held for a while.
    struct Rub {
        Stick stick;
        FrictionSpring spring;  ///< as stiff as the normal one
    };
    /// The friction of `touches`: samples that stuck before do so at the same place, others where they were at `start`.
    std::vector<Rub> rubs(std::span<const Collider> colliders, std::span<const Touch> touches,
                          std::span<const Stick> sticks, std::span<const Vec3> start) const;
    /// Coulomb friction by springs from the anchors.
    void add_friction_forces(std::span<const Rub> rubs, std::span<const Vec3> x, std::span<Vec3> f) const;
    /// Adds the derivative of its negative, applied to `d`; symmetric and never negative.
    void add_friction_action(std::span<const Rub> rubs, std::span<const Vec3> x, std::span<const Vec3> d,
                             std::span<Vec3> out) const;
    /// The anchors after a step that ends at `x`, dragged along by those that slid; ascending.
    std::vector<Stick> sticks(std::span<const Rub> rubs, std::span<const Vec3> x) const;

    /// Adds the stiffness of contact and of friction that sticks, lumped to the nodes, to `blocks` [nodes] [N/m]: for
    /// preconditioners.
    void add_lumped(std::span<const Touch> touches, std::span<const Rub> rubs, std::span<const Vec3> x,
                    std::span<Mat3> blocks) const;

    // --- for other bodies (contact/body_contact.h)

    /// The refined surface; its vertices are the samples.
    const MovingSurface& surface() const { return surface_; }
    /// Whether it keeps the samples of others out.
    bool has_inside() const { return has_inside_; }
    const EmbeddedPoints& samples() const { return samples_; }
    double stiffness(std::size_t sample) const { return stiffness_share_ / (step_squared_ * inverse_mass_[sample]); }
    /// Of a sample that is pressed on by others with an effective inverse mass `w` [1/kg].
    double stiffness_against(double w) const { return stiffness_share_ / (step_squared_ * w); }
    double node_inverse_mass(std::size_t node) const { return node_inverse_mass_[node]; }
    /// A box around all samples when the nodes are at x.
    Bounds reach(std::span<const Vec3> x) const;
    /// Calls `visit(begin, end)` for samples that lie together, where they may be inside of `box`.
    template <class Visit>
    void visit_near(const Bounds& box, std::span<const Vec3> x, Visit&& visit) const {
        for (const Group& group : groups_)
            if (reach_of(group, x).overlaps(box)) visit(group.begin, group.end);
    }

    /// How deep [m] the deepest sample is inside of an obstacle; 0 when none is.
    double deepest(std::span<const Collider> colliders, std::span<const Vec3> x, const Threads& threads) const;

    /// Adds the surface and what carries it to a hash.
    void add_to(Hasher& hasher) const;

    /// Stored energy [J].
    double energy(std::span<const Collider> colliders, std::span<const Vec3> x, const Threads& threads) const;

private:
    /// Adds a force at a sample to the nodes that carry it.
    void spread(std::size_t sample, const Vec3& force, std::span<Vec3> f) const {
        for (std::uint32_t k = samples_.offset[sample]; k < samples_.offset[sample + 1]; ++k)
            f[samples_.node[k]] += samples_.phi[k] * force;
    }
    std::vector<Touch> touches(std::span<const Collider> colliders, std::span<const Vec3> x,
                               const Threads& threads) const;

    /// Samples that lie together, and the nodes that carry them: out of reach when the nodes are.
    struct Group {
        std::uint32_t begin, end;  ///< samples
        std::vector<std::uint32_t> nodes;
        double stands_out = 0;  ///< [m] see below
    };
    /// How far samples are from the nearest of their nodes, where any lies outside of the box of the group's nodes;
    /// else 0.
    double stands_out(const Group& group, std::span<const Vec3> positions, std::span<const Vec3> rest) const;

    Vec3 slip(const Rub& rub, std::span<const Vec3> x) const {
        return rub.spring.slip(samples_.position(rub.stick.sample, x) - rub.stick.anchor);
    }
    /// Bounding box of a group's nodes, widened: shape functions have some negative values, and samples may stand out.
    static Bounds reach_of(const Group& group, std::span<const Vec3> x);

    EmbeddedPoints samples_;  ///< in the order of the groups
    MovingSurface surface_;
    bool has_inside_;
    std::vector<Group> groups_;
    std::vector<double> inverse_mass_;       ///< [samples] w_s [1/kg]
    std::vector<double> own_inverse_mass_;   ///< [samples] sum phi^2/m, that of the sample alone [1/kg]
    std::vector<double> node_inverse_mass_;  ///< [nodes] [1/kg]
    double stiffness_share_ = explicit_share;
    double step_squared_ = 0;  ///< dt^2 of the stiffness [s^2]
};

}  // namespace phyxel
