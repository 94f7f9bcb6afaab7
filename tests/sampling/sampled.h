#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/clipping_shapes.h"
#include "geometry/mesh_check.h"
#include "sampling/sampling.h"

/// Bodies on all lattices with all quadratures, for the tests of everything that is built on them.

namespace phyxel {

/// Where nodes and points of a body lie, with the name for messages.
struct Scheme {
    std::string name;
    Lattice lattice;
    Quadrature quadrature;
};

inline std::vector<Scheme> all_schemes() {
    return {{"cubic grid", Lattice::cubic, Quadrature::grid},
            {"bcc grid", Lattice::bcc, Quadrature::grid},
            {"cubic nodes", Lattice::cubic, Quadrature::nodes},
            {"bcc nodes", Lattice::bcc, Quadrature::nodes}};
}

/// The scheme with the weight that goes with it and a material of 1 MPa.
inline BodySettings settings_of(const Scheme& scheme) {
    BodySettings settings;
    settings.lattice = scheme.lattice;
    settings.quadrature = scheme.quadrature;
    if (scheme.quadrature == Quadrature::nodes) settings.kernel.shape = KernelShape::poly6;
    settings.material = {.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3, .law = Law::neo_hookean};
    return settings;
}

/// Node spacing of a scheme whose nodes are as far apart as those of a cubic lattice of spacing `a`.
inline double equal_spacing(const Scheme& scheme, double a) {
    return scheme.lattice == Lattice::bcc ? a * std::cbrt(2.0) : a;
}

/// A lattice that fits no face of the body.
inline BodySettings turned(BodySettings settings) {
    settings.lattice_rotation = {{1, 2, -1}, 40};
    settings.lattice_offset = {0.31, 0.17, 0.43};
    return settings;
}

/// The scanned bunny, one metre long.
inline TriangleMesh unit_bunny() {
    TriangleMesh mesh = bunny();
    const double size = body_size(mesh);
    for (Vec3& X : mesh.vertices) X /= size;
    return mesh;
}

/// The cube, the sphere and the bunny of the patch tests, each about a metre long.
inline std::vector<std::pair<std::string, TriangleMesh>> patch_bodies() {
    return {{"cube", make_box({1, 1, 1})}, {"sphere", make_sphere(0.5)}, {"bunny", unit_bunny()}};
}

inline Sampling sampled(const TriangleMesh& mesh, const BodySettings& settings, double spacing, int threads = 2) {
    return sample(check_and_repair(mesh), settings, spacing, Threads(threads));
}

}  // namespace phyxel
