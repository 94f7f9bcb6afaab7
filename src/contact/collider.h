#pragma once

#include <variant>

#include "base/hash.h"
#include "phyxel/body.h"

namespace phyxel {

/// Signed distance [m] of a point from a solid obstacle, negative inside, and the unit direction out of it.
struct Distance {
    double value;
    Vec3 normal;
};

/// An obstacle that does not move.
class Collider {
public:
    /// Throws `Error` naming the field when a size, a normal or a friction coefficient is out of range.
    explicit Collider(const Plane& plane);
    explicit Collider(const Sphere& sphere);
    explicit Collider(const Box& box);

    Distance distance(const Vec3& x) const;
    /// Lower bound of the distance of every point in the box [low, high].
    double distance_to_box(const Vec3& low, const Vec3& high) const;
    double friction() const { return friction_; }
    /// Adds kind, place, size and friction to a hash.
    void add_to(Hasher& hasher) const;

private:
    struct HalfSpace {
        Vec3 point, normal;
    };
    struct Ball {
        Vec3 center;
        double radius;
    };
    struct Block {
        Vec3 center, half_size;
        Mat3 rotation;  ///< columns: the box's axes
    };
    std::variant<HalfSpace, Ball, Block> shape_;
    double friction_;
};

}  // namespace phyxel
