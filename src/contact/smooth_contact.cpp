#include "contact/contact.h"

namespace phyxel {
namespace {

/// Tangential slip of a sample, and the first derivative of the friction potential over the slip, phi'(|u|)/|u|.
struct Slip {
    Vec3 way;
    double over;
};

Slip slip_of(const Vec3& moved, const Vec3& normal, double reach) {
    const Vec3 way = moved - dot(moved, normal) * normal;
    const double length = norm(way);
    return {way, length >= reach ? 1 / length : (2 - length / reach) / reach};
}

}  // namespace

void ContactSamples::add_action(std::span<const Touch> touches, std::span<const Vec3> d, std::span<Vec3> out) const {
    for (const Touch& touch : touches)
        spread(touch.sample,
               stiffness(touch.sample) * dot(touch.normal, samples_.position(touch.sample, d)) * touch.normal, out);
}

void ContactSamples::add_smooth_friction(std::span<const Collider> colliders, std::span<const Touch> touches,
                                         double reach, std::span<const Vec3> x, std::span<const Vec3> start,
                                         std::span<Vec3> f) const {
    for (const Touch& touch : touches) {
        const Vec3 moved = samples_.position(touch.sample, x) - samples_.position(touch.sample, start);
        const Slip slip = slip_of(moved, touch.normal, reach);
        spread(touch.sample, -colliders[touch.collider].friction() * touch.push * slip.over * slip.way, f);
    }
}

void ContactSamples::add_smooth_friction_action(std::span<const Collider> colliders, std::span<const Touch> touches,
                                                double reach, std::span<const Vec3> x, std::span<const Vec3> start,
                                                std::span<const Vec3> d, std::span<Vec3> out) const {
    for (const Touch& touch : touches) {
        const Vec3 moved = samples_.position(touch.sample, x) - samples_.position(touch.sample, start);
        const Slip slip = slip_of(moved, touch.normal, reach);
        const Vec3 change = samples_.position(touch.sample, d);
        Vec3 along = change - dot(change, touch.normal) * touch.normal;
        // Beyond the reach the force only turns with the slip; below it also grows, by 2 (1 - y)/reach along the slip.
        const double length_squared = norm_squared(slip.way);
        Vec3 result = slip.over * along;
        if (length_squared > 0) {
            const double length = std::sqrt(length_squared);
            const double grows = length >= reach ? 0 : 2 * (1 - length / reach) / reach;
            result += (grows - slip.over) * dot(along, slip.way) / length_squared * slip.way;
        }
        spread(touch.sample, colliders[touch.collider].friction() * touch.push * result, out);
    }
}

}  // namespace phyxel
