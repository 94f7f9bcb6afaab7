#include "contact/collider.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "phyxel/error.h"
#include "sampling/lattice_frame.h"

namespace phyxel {
namespace {

double checked_friction(double friction) {
    if (!(friction >= 0) || !std::isfinite(friction))
        throw Error("collider friction: found " + std::to_string(friction) +
                    ", expected a finite number of at least 0");
    return friction;
}

double checked_size(double size, const char* field) {
    if (!(size > 0) || !std::isfinite(size))
        throw Error(std::string(field) + ": found " + std::to_string(size) + ", expected a finite number above 0 [m]");
    return size;
}

Vec3 checked_direction(const Vec3& direction, const char* field) {
    if (!is_finite(direction) || norm(direction) == 0)
        throw Error(std::string(field) + ": expected a finite vector of any length but zero");
    return normalized(direction);
}

Vec3 checked_point(const Vec3& point, const char* field) {
    if (!is_finite(point)) throw Error(std::string(field) + ": expected finite coordinates [m]");
    return point;
}

Distance distance_from(const Vec3& d, const Vec3& half) {
    // Beyond which faces, and how far inside of the nearest one.
    Vec3 outside{};
    int nearest = 0;
    for (int c = 0; c < 3; ++c) {
        const double beyond = std::abs(d[c]) - half[c];
        if (beyond > 0) outside[c] = std::copysign(beyond, d[c]);
        if (beyond > std::abs(d[nearest]) - half[nearest]) nearest = c;
    }
    const double length = norm(outside);
    if (length > 0) return {length, outside / length};
    Vec3 normal{};
    normal[nearest] = d[nearest] < 0 ? -1 : 1;
    return {std::abs(d[nearest]) - half[nearest], normal};
}

}  // namespace

Collider::Collider(const Plane& plane)
    : shape_(HalfSpace{checked_point(plane.point, "plane.point"), checked_direction(plane.normal, "plane.normal")}),
      friction_(checked_friction(plane.friction)) {}

Collider::Collider(const Sphere& sphere)
    : shape_(Ball{checked_point(sphere.center, "sphere.center"), checked_size(sphere.radius, "sphere.radius")}),
      friction_(checked_friction(sphere.friction)) {}

Collider::Collider(const Box& box) : friction_(checked_friction(box.friction)) {
    for (int c = 0; c < 3; ++c) checked_size(box.size[c], "box.size");
    checked_direction(box.rotation.axis, "box.rotation.axis");
    if (!std::isfinite(box.rotation.degrees)) throw Error("box.rotation.degrees: expected a finite number");
    shape_ = Block{checked_point(box.center, "box.center"), 0.5 * box.size, rotation_matrix(box.rotation)};
}

Distance Collider::distance(const Vec3& x) const {
    if (const auto* plane = std::get_if<HalfSpace>(&shape_))
        return {dot(x - plane->point, plane->normal), plane->normal};
    if (const auto* ball = std::get_if<Ball>(&shape_)) {
        const Vec3 d = x - ball->center;
        const double length = norm(d);
        return {length - ball->radius, length > 0 ? d / length : Vec3{0, 1, 0}};
    }
    const Block& block = std::get<Block>(shape_);
    Distance local = distance_from(transpose(block.rotation) * (x - block.center), block.half_size);
    local.normal = block.rotation * local.normal;
    return local;
}

void Collider::add_to(Hasher& hasher) const {
    hasher.add_value(static_cast<std::uint64_t>(shape_.index()));
    std::visit([&](const auto& shape) { hasher.add_value(shape); }, shape_);
    hasher.add_value(friction_);
}

double Collider::distance_to_box(const Vec3& low, const Vec3& high) const {
    const Vec3 center = 0.5 * (low + high), half = 0.5 * (high - low);
    if (const auto* plane = std::get_if<HalfSpace>(&shape_)) {
        const Vec3& n = plane->normal;
        return dot(center - plane->point, n) -
               (std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z);
    }
    // A signed distance changes by at most the way.
    return distance(center).value - norm(half);
}

}  // namespace phyxel
