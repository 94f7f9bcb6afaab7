#pragma once

#include "phyxel/vector.h"

namespace phyxel {

/// Coulomb friction of one point against a surface with normal `normal`: a spring along the surface, no stronger than
/// `limit` [N] (Cundall and Strack 1979). What rests on a slope stays where it is, where a force that only opposes
/// velocity would let it creep.
struct FrictionSpring {
    Vec3 normal;
    double limit = 0;      ///< mu f_n [N]
    double stiffness = 0;  ///< [N/m]

    /// The part of a way from the anchor that the spring resists.
    Vec3 slip(const Vec3& way) const { return way - dot(way, normal) * normal; }
    bool holds(const Vec3& slip) const { return stiffness * norm(slip) <= limit; }
    Vec3 force(const Vec3& slip) const { return -(holds(slip) ? stiffness : limit / norm(slip)) * slip; }
    /// Change of the negative force with the slip by `change`, which lies in the surface; never negative.
    Vec3 action(const Vec3& slip, const Vec3& change) const {
        if (holds(slip)) return stiffness * change;
        // A force that keeps its size turns with the slip.
        return limit / norm(slip) * (change - dot(change, slip) / norm_squared(slip) * slip);
    }
    /// What is left of the slip when the anchor is dragged along.
    Vec3 kept(const Vec3& slip) const { return holds(slip) ? slip : limit / (stiffness * norm(slip)) * slip; }
    /// While it holds; zero when it slides.
    Mat3 held_stiffness(const Vec3& slip) const {
        return (holds(slip) ? stiffness : 0) * (Mat3::identity() - outer(normal, normal));
    }
};

}  // namespace phyxel
