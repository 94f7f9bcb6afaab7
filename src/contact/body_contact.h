#pragma once

#include "contact/contact.h"

namespace phyxel {

/// What friction between two bodies holds: how far a sample has been pulled along the other's surface.
struct BodyStick {
    std::uint32_t sample;
    std::uint32_t other;  ///< number of the other body
    Vec3 stretch;         ///< [m]
};

/// Contact of bodies with each other, in one implicit step.
///
/// Every sample of each body is held against the surface of each other that has an inside: d = n . (x_s - y), y the
/// nearest point of that surface, carried by its nodes as the sample is by its own, and n the outward direction there.
/// Both are found by `find` and kept until the next, so that what a pair stores, k/2 min(0, d)^2, is a smooth function
/// of the positions of both bodies' nodes, and its forces sum to zero. The springs of both bodies act in series.
///
/// Friction: springs along the surface, no stronger than mu times the normal force that was last found, mu = sqrt(mu_1
/// mu_2). Their stretch outlasts the step.
class BodyContact {
public:
    struct Side {
        const ContactSamples* surface;
        std::uint32_t number;                  ///< of the body
        std::size_t first, nodes;              ///< its nodes in the vector over all
        double friction;                       ///< coefficient
        double spacing;                        ///< [m]
        std::span<const BodyStick> sticks;     ///< ascending
        std::span<const std::uint32_t> apart;  ///< numbers of bodies that it does not meet, ascending
    };
    explicit BodyContact(std::vector<Side> sides) : sides_(std::move(sides)) {}

    /// Finds the pairs that touch or nearly do at `x`, which two bodies came to by at most `motion` [m] against each
    /// other: no sample is much deeper. Slip counts from `start`, where the bodies were.
    void find(const std::vector<Vec3>& x, const std::vector<Vec3>& start, double motion, const Threads& threads);
    bool empty() const { return pairs_.empty(); }

    void add_forces(const std::vector<Vec3>& x, std::vector<Vec3>& f) const;
    void add_friction_forces(const std::vector<Vec3>& x, std::vector<Vec3>& f) const;
    /// Second derivatives of both applied to `d`; never negative.
    void add_action(const std::vector<Vec3>& x, const std::vector<Vec3>& d, std::vector<Vec3>& out) const;
    /// Adds their stiffness lumped to the nodes [N/m], for preconditioners.
    void add_lumped(const std::vector<Vec3>& x, std::vector<Mat3>& blocks) const;

    /// Energy [J] that the pairs of one side's samples store.
    double energy(std::size_t side, const std::vector<Vec3>& x) const;
    /// What friction holds at the end of a step, ascending.
    std::vector<BodyStick> sticks(std::size_t side, const std::vector<Vec3>& x) const;
    /// Samples of one side that are inside of another body.
    std::size_t touching(std::size_t side, const std::vector<Vec3>& x) const;
    /// How deep the deepest sample of any body is inside of another [m].
    double deepest(const std::vector<Vec3>& x) const;

private:
    /// sum of weight x_node = x_s - y.
    struct Entry {
        std::uint32_t node;
        double weight;
    };
    struct Pair {
        std::uint32_t side, other, sample;
        std::uint32_t begin, end;  ///< into `entries_`
        FrictionSpring spring;     ///< as stiff as the normal one; without a limit there is no friction
        Vec3 origin{};             ///< x_s - y at the start of the step, less the stretch it began with
    };

    void find_between(std::uint32_t side, std::uint32_t other, double motion,
                      const std::vector<std::vector<Vec3>>& places, const std::vector<Vec3>& x, const Threads& threads);
    void set_stiffness();
    void set_friction(const std::vector<Vec3>& x, const std::vector<Vec3>& start);

    Vec3 apart(const Pair& pair, const std::vector<Vec3>& x) const {
        Vec3 sum{};
        for (std::uint32_t k = pair.begin; k < pair.end; ++k) sum += entries_[k].weight * x[entries_[k].node];
        return sum;
    }
    void spread(const Pair& pair, const Vec3& force, std::vector<Vec3>& f) const {
        for (std::uint32_t k = pair.begin; k < pair.end; ++k) f[entries_[k].node] += entries_[k].weight * force;
    }
    Vec3 slip(const Pair& pair, const std::vector<Vec3>& x) const {
        return pair.spring.slip(apart(pair, x) - pair.origin);
    }

    std::vector<Side> sides_;
    std::vector<Pair> pairs_;
    std::vector<Entry> entries_;
};

}  // namespace phyxel
