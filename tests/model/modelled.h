#pragma once

#include <random>

#include "model/model.h"
#include "sampling/sampled.h"

/// Models and states for the tests of forces and steps.

namespace phyxel {

inline Model modelled(const TriangleMesh& mesh, const BodySettings& settings, double spacing) {
    StencilReport report;
    return build_model(sampled(mesh, settings, spacing), settings, Threads(2), report);
}

/// A body under test with its name for messages.
struct NamedModel {
    std::string name;
    Model model;
};

/// Whole cubic cells with a point at each node: the bodies of Stegmayr 2008.
inline Model whole_cell_model(const std::array<int, 3>& counts, double spacing, const BodySettings& settings) {
    StencilReport report;
    return build_model(whole_cells(counts, spacing), settings, Threads(2), report);
}

/// Uniform random vectors in the cube of half side `size`.
inline std::vector<Vec3> random_field(std::size_t count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Vec3> field(count);
    for (Vec3& v : field) v = size * random_vector(random);
    return field;
}

/// Where x = F X + shift puts the nodes.
inline std::vector<Vec3> affine(const Model& model, const Mat3& F, const Vec3& shift = {}) {
    std::vector<Vec3> x;
    for (const Vec3& X : model.rest) x.push_back(F * X + shift);
    return x;
}

inline Mat3 some_rotation() { return rotation_about(normalized(Vec3{1, 2, -1}), 1.0); }
inline Mat3 some_stretch() { return {{{1.2, 0.3, 0}, {0, 0.9, 0.1}, {-0.2, 0, 1.1}}}; }

/// Turned by one radian, stretched and sheared by up to a third, shaken by a twentieth of the node spacing.
inline std::vector<Vec3> turned_stretched_and_shaken(const Model& model, unsigned seed = 3) {
    std::vector<Vec3> x = affine(model, some_rotation() * some_stretch(), {0.3, -0.2, 0.1});
    const std::vector<Vec3> shake = random_field(x.size(), 0.05 * model.node_length, seed);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += shake[i];
    return x;
}

inline double largest(std::span<const Vec3> field) {
    double size = 0;
    for (const Vec3& v : field) size = std::max(size, norm(v));
    return size;
}

inline double largest_difference(std::span<const Vec3> a, std::span<const Vec3> b) {
    double size = 0;
    for (std::size_t i = 0; i < a.size(); ++i) size = std::max(size, norm(a[i] - b[i]));
    return size;
}

inline double inner(std::span<const Vec3> a, std::span<const Vec3> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
    return sum;
}

/// Net force, over the sum of the forces' sizes.
inline double net_force(std::span<const Vec3> f) {
    Vec3 sum;
    double size = 0;
    for (const Vec3& force : f) sum += force, size += norm(force);
    return norm(sum) / size;
}

/// Net torque about the middle of the body, over the sum of arms times forces.
inline double net_torque(std::span<const Vec3> x, std::span<const Vec3> f) {
    Vec3 middle, sum;
    for (const Vec3& p : x) middle += p / static_cast<double>(x.size());
    double size = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        sum += cross(x[i] - middle, f[i]);
        size += norm(x[i] - middle) * norm(f[i]);
    }
    return norm(sum) / size;
}

}  // namespace phyxel
