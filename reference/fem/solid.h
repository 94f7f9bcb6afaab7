#pragma once

#include <cstddef>
#include <vector>

#include "material/law.h"
#include "phyxel/material.h"
#include "phyxel/vector.h"
#include "reference/fem/mesh.h"

/// Finite elements of an elastic solid, total Lagrangian: x = sum phi_i x_i in every element, F = sum x_i (x) g_i at
/// every quadrature point, and the energy U = sum V Psi(F). The laws are the library's own (src/material), so that what
/// differs from the meshless solver is the discretization and nothing else; with the corotated law F = R S at every
/// point.

namespace phyxel::fem {

/// A mesh with its material and what follows from the rest positions.
struct Solid {
    Mesh mesh;
    MaterialPoint material;
    double density = 0;  ///< [kg/m^3]
    std::size_t points_per_element = 0;
    std::vector<double> V;  ///< [elements x points of one] rest volumes [m^3]
    std::vector<Vec3> g;    ///< [elements x points of one x nodes of one] shape gradients [1/m]

    Solid(Mesh mesh, const Material& material);
};

/// What acts on a solid.
struct Conditions {
    std::vector<Vec3> force;  ///< [nodes] dead forces [N]
    std::vector<char> fixed;  ///< [3 nodes] 1 where a coordinate keeps its value; x, y, z of node 0, x of node 1, ...

    explicit Conditions(const Solid& solid) : force(solid.mesh.X.size()), fixed(3 * solid.mesh.X.size()) {}
};

/// Fixes all three coordinates of the nodes of a face.
void clamp(Conditions& conditions, const Solid& solid, Face face);

/// Adds a dead force [N], uniform per rest area of a face.
void add_face_force(Conditions& conditions, const Solid& solid, Face face, const Vec3& total);

/// Adds the weight under the acceleration `gravity` [m/s^2].
void add_gravity(Conditions& conditions, const Solid& solid, const Vec3& gravity);

/// Deformation gradient at point `point` of element `element`, for positions x [nodes].
Mat3 deformation_gradient(const Solid& solid, const std::vector<Vec3>& x, std::size_t element, std::size_t point);

/// Elastic energy [J] at positions x.
double elastic_energy(const Solid& solid, const std::vector<Vec3>& x);

/// Forces of the deformed material on the nodes [N], the negative gradient of the energy: f_i = -sum V P g_i.
std::vector<Vec3> elastic_forces(const Solid& solid, const std::vector<Vec3>& x);

}  // namespace phyxel::fem
