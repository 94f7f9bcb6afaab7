#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "phyxel/material.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// A rotation given as an axis (any length but zero) and an angle.
struct AxisAngle {
    Vec3 axis{0, 1, 0};
    double degrees = 0;
};

/// How nodes are placed in a body.
enum class Lattice {
    cubic,  ///< spacing: edge of the cube of each node
    bcc,    ///< body-centred cubic; spacing: edge of the conventional cell, which holds two nodes
};

/// Where the material is evaluated.
enum class Quadrature {
    grid,   ///< eight points in each node's cell (Brunet et al. 2019): accurate; the default
    nodes,  ///< one point, at the node (Stegmayr 2008): a preview, four to eight times cheaper
};

/// Weight functions w(s), s = distance / support radius, zero from s = 1 on. Formulas: approximation/kernel.h.
enum class KernelShape { quartic_spline, poly6, cubic_spline, wendland };

/// Weight of a node at a quadrature point.
struct Kernel {
    std::optional<KernelShape> shape{};  ///< nothing: quartic spline with grid quadrature, poly6 with nodes
    double support = 0;  ///< support radius in spacings, 1.2 to 8; 0: 2.2 with grid quadrature, 1.8 with nodes
    int neighbors = 0;   ///< > 0: support from the mean distance of that many nearest nodes, times `dilation`
    double dilation = 1.2;
};

/// Where a region is, rest space [m].
struct BoxRegion {
    Vec3 lower, upper;
};
struct SphereRegion {
    Vec3 center;
    double radius = 0;  ///< > 0
};

/// A part of a body with a material of its own. What lies outside of the body does not matter.
struct Region {
    std::variant<BoxRegion, SphereRegion, TriangleMesh> shape;  ///< a mesh: inside of its closed surface
    Material material{};
    double transition = 0;  ///< [m] >= 0: width over which moduli and density change linearly, half on either side of
                            ///< the region's boundary; needs the law of what it changes from
};

/// How a surface mesh becomes a soft body.
struct BodySettings {
    double scale = 1;      ///< first; makes the mesh's unit metres
    AxisAngle rotation{};  ///< then
    Vec3 translation{};    ///< then [m]; the result is the body's rest space
    Vec3 velocity{};       ///< initial, uniform [m/s]

    double spacing = 0;        ///< node spacing [m], exact; 0: from `count`. Smaller: finer and slower
    std::size_t count = 2000;  ///< number of nodes aimed at when `spacing` is 0
    Lattice lattice = Lattice::cubic;
    AxisAngle lattice_rotation{};  ///< of the lattice against the body's own axes
    Vec3 lattice_offset{};         ///< shift of the lattice, in spacings
    Quadrature quadrature = Quadrature::grid;
    Kernel kernel{};

    Material material{};
    std::vector<Region> regions{};  ///< of other materials; later ones win

    /// Grid quadrature only: the points of a lattice cell share the mean of their dilatations, so that nearly
    /// incompressible material does not lock. Nothing: where Poisson's ratio is above 0.47.
    std::optional<bool> mean_dilatation{};

    bool consistency_correction = true;  ///< exact patch test on clipped cells (docs/stages/consistency.md)
    double friction = 0.5;               ///< Coulomb coefficient against other bodies: sqrt(mu_1 mu_2) between two
    double stabilization = -1;           ///< strength; -1: 0.2 with grid quadrature, 0.15 with nodes; 0: none

    /// Meets colliders and other bodies in place of the body's own surface; in the coordinates of the mesh, and carried
    /// by the nodes as it is. Lies inside of the body, or outside by less than the kernel's support. An open one has no
    /// inside: its points are kept out of other bodies, theirs are not kept out of it.
    std::optional<TriangleMesh> contact_mesh{};
    std::string name{};  ///< what messages call the body; empty: its number in the world
};

/// A body's name in its world: an index and a generation, so that a removed body's id is never taken for another's.
struct BodyId {
    std::uint32_t index = 0, generation = 0;
    friend bool operator==(const BodyId&, const BodyId&) = default;
};

/// The part of a surface inside the closed box, in rest space; triangles are clipped to it.
struct BoxSelection {
    Vec3 lower, upper;
};

/// A keyframe of a moving grip: displacement and rotation at a time, linear in between.
struct GripKey {
    double time = 0;      ///< [s]
    Vec3 displacement{};  ///< [m]
    double degrees = 0;   ///< about `Fix::axis` through `Fix::center`
};

/// Holds the selected surface where it is, or moves it. Exact in explicit steps: a mass-weighted projection of the
/// velocities, so that it stores no energy and lowers no time step.
struct Fix {
    BoxSelection box;
    bool x = true, y = true, z = true;  ///< directions held; fewer make rollers and symmetry planes
    Vec3 axis{0, 0, 1};                 ///< of the rotation; any length but zero
    Vec3 center{};                      ///< of the rotation [m], rest space
    std::vector<GripKey> path{};        ///< empty: stays; before the first key and after the last: constant
};

/// Force [N] and torque [N m] that a fix exerts on its body, means over the last step; torque about the rest centre of
/// what is held, moved with it.
struct Reaction {
    Vec3 force, torque;
};

/// A load on the selected surface, uniform per rest area. Exactly one of the three is set.
struct Load {
    BoxSelection box;
    std::optional<Vec3> force{};       ///< [N] total, dead
    std::optional<Vec3> traction{};    ///< [Pa] per rest area, dead
    std::optional<double> pressure{};  ///< [Pa], following the surface, along the inward current normal
    double ramp = 0;                   ///< [s] to full load, linear
};

/// Half space behind a plane; `normal` points to where bodies may be.
struct Plane {
    Vec3 point{};
    Vec3 normal{0, 1, 0};   ///< any length but zero
    double friction = 0.5;  ///< Coulomb coefficient, >= 0
};

struct Sphere {
    Vec3 center{};
    double radius = 0;  ///< [m], > 0
    double friction = 0.5;
};

struct Box {
    Vec3 center{};
    Vec3 size{};  ///< full sides [m], > 0
    AxisAngle rotation{};
    double friction = 0.5;
};

}  // namespace phyxel
