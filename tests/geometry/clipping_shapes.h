#pragma once

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "geometry/clipping.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

/// Bodies and measures for the tests of clipping.

namespace phyxel {

/// The scanned bunny; its file holds plain vertices and triangles (the real readers live in a folder further down).
inline TriangleMesh bunny() {
    std::ifstream file(std::string(PHYXEL_SOURCE_DIR) + "/scenes/meshes/bunny.obj");
    TriangleMesh mesh;
    for (std::string line; std::getline(file, line);) {
        double x, y, z;
        unsigned a, b, c;
        if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) mesh.vertices.push_back({x, y, z});
        if (std::sscanf(line.c_str(), "f %u %u %u", &a, &b, &c) == 3) mesh.triangles.push_back({a - 1, b - 1, c - 1});
    }
    return mesh;
}

inline TriangleMesh transformed(TriangleMesh mesh, const Mat3& rotation, const Vec3& shift) {
    for (Vec3& v : mesh.vertices) v = rotation * v + shift;
    return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Vec3& by) {
    for (Vec3& v : mesh.vertices) v += by;
    return mesh;
}

inline Vec3 random_vector(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    return {x, y, z};
}

/// Turned and shifted at random.
inline TriangleMesh posed(TriangleMesh mesh, int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const Vec3 axis = normalized(random_vector(random));
    const double angle = 3 * random_vector(random).x;
    return transformed(std::move(mesh), rotation_about(axis, angle), random_vector(random));
}

inline TriangleMesh inverted(TriangleMesh mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
    const auto shift = static_cast<std::uint32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    return a;
}

inline std::vector<std::pair<std::string, TriangleMesh>> test_bodies() {
    return {{"box", make_box({1, 2, 0.7})},
            {"sphere", make_sphere(1)},
            {"cylinder", make_cylinder(0.5, 2)},
            {"torus", make_torus(1, 0.3)},
            {"bunny", bunny()}};
}

inline Vec3 lower_corner(const TriangleMesh& mesh) {
    Vec3 lower = mesh.vertices[0];
    for (const Vec3& v : mesh.vertices)
        for (std::size_t c = 0; c < 3; ++c) lower[c] = std::min(lower[c], v[c]);
    return lower;
}

/// Longest side of the bounding box.
inline double body_size(const TriangleMesh& mesh) {
    const Vec3 lower = lower_corner(mesh);
    double size = 0;
    for (const Vec3& v : mesh.vertices)
        for (std::size_t c = 0; c < 3; ++c) size = std::max(size, v[c] - lower[c]);
    return size;
}

struct VolumeMoments {
    double volume = 0;
    Vec3 moment;
};

/// By the divergence theorem, tetrahedra against the first vertex.
inline VolumeMoments volume_moments(const TriangleMesh& mesh) {
    const Vec3 origin = mesh.vertices[0];
    VolumeMoments sum;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
        const double volume = dot(a, cross(b, c)) / 6;
        sum.volume += volume;
        sum.moment += volume / 4 * (a + b + c);
    }
    sum.moment += sum.volume * origin;
    return sum;
}

struct ClosureErrors {
    double area;    ///< |sum area| / sum |area|
    double volume;  ///< |sum position (x) area - volume I| / (sum |position| |area|)
};

inline ClosureErrors closure_errors(const ClippedVolume& clip) {
    Vec3 area;
    Mat3 spanned;
    double total = 0, arm = 0;
    const Vec3 origin = clip.boundary.front().position;
    for (const SurfacePoint& p : clip.boundary) {
        area += p.area;
        spanned += outer(p.position - origin, p.area);
        total += norm(p.area);
        arm += norm(p.position - origin) * norm(p.area);
    }
    return {norm(area) / total, norm(spanned - clip.volume * Mat3::identity()) / arm};
}

inline bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

inline bool same_bits(const ClippedVolume& a, const ClippedVolume& b) {
    if (a.octants.size() != b.octants.size() || a.boundary.size() != b.boundary.size()) return false;
    for (std::size_t o = 0; o < a.octants.size(); ++o)
        if (a.octants[o].index != b.octants[o].index || a.octants[o].volume != b.octants[o].volume ||
            !same_bits(a.octants[o].centroid, b.octants[o].centroid))
            return false;
    for (std::size_t p = 0; p < a.boundary.size(); ++p)
        if (!same_bits(a.boundary[p].position, b.boundary[p].position) ||
            !same_bits(a.boundary[p].area, b.boundary[p].area))
            return false;
    return a.volume == b.volume && a.leak == b.leak;
}

}  // namespace phyxel
