#pragma once

#include <cstddef>
#include <vector>

#include "phyxel/vector.h"

/// The corotated meshless method as in
///     J.-N. Brunet, V. Magnoux, B. Ozell, S. Cotin, "Corotated meshless implicit dynamics for deformable bodies",
///     WSCG 2019 (Computer Science Research Notes 2901), 91-100,
/// once more, slowly, one equation at a time and with 6-vectors of strain as printed. Where the print is wrong both are
/// here, so that tests and studies can show what it costs. Nothing of it is used by the library.

namespace phyxel::reference::brunet {

/// An integration point I with its neighbourhood. Arrays: one entry a neighbour.
struct Stencil {
    std::vector<std::size_t> nodes;
    std::vector<double> phi;  ///< shape values, eq. 8
    std::vector<Vec3> g;      ///< their gradients [1/m], eq. 8
    double volume = 0;        ///< v_I [m^3]
};

struct Body {
    std::vector<Vec3> X;          ///< [nodes] rest positions [m]
    std::vector<Stencil> points;  ///< integration points
    double lambda = 0, mu = 0;    ///< Lamé's moduli [Pa]
};

/// Which rotation is taken out of the displacement.
enum class Rotation {
    printed,                  ///< eq. 11: that of the neighbourhood's moment matrix
    of_deformation_gradient,  ///< right: that of F
};

/// Quartic spline weight of section 3.3 at distance s h.
double quartic_spline(double s);

/// Stencil of a point with every node closer than h: eq. 8 with a linear basis, shifted to the point and scaled by h,
/// and the derivative of the inverse as -A^-1 A_,x A^-1.
Stencil moving_least_squares(const std::vector<Vec3>& X, const Vec3& point, double h, double volume);

/// [nodes] v_j [m^3] of eq. 11: the volume of every integration point, split evenly among its neighbours.
std::vector<double> node_volumes(const Body& body);

/// F = sum x_j (x) g_j at an integration point.
Mat3 deformation_gradient(const Stencil& point, const std::vector<Vec3>& x);

/// A_I = sum_j v_j (x_j - x_I) (X_j - X_I)^T, eq. 11, with x_I from eq. 6.
Mat3 transformation(const Body& body, const Stencil& point, const std::vector<double>& node_volume,
                    const std::vector<Vec3>& x);

/// Rotation R of A = R S. The determinant must be positive.
Mat3 rotation_factor(const Mat3& A);

/// [points] R_I at positions x.
std::vector<Mat3> rotations(const Body& body, const std::vector<Vec3>& x, Rotation rotation);

/// [nodes] forces of the deformed material on the nodes [N], eq. 12 with the sign of a force:
/// f_i = -sum_I v_I R_I B_i^T C sum_j B_j (R_I^T x_j - X_j).
/// With the rotation of F they are the negative gradient of `energy`, with that of eq. 11 of nothing.
std::vector<Vec3> forces(const Body& body, const std::vector<Vec3>& x, Rotation rotation);

/// Energy [J] of the corotated solid, sum_I v_I/2 eps^T C eps with eps = sum_j B_j (R_I^T x_j - X_j), R that of F.
double energy(const Body& body, const std::vector<Vec3>& x);

/// What the force on neighbour a of a point answers to a movement of neighbour b while R stands still [N/m], eq. 14:
/// v R B_a^T C B_b R^T = v [lambda g'_a g'_b^T + mu g'_b g'_a^T + mu (g_a . g_b) I], g' = R g.
/// (Printed with B_b transposed, a product of matrices that do not fit.) Semidefinite at any state, as it lacks the
/// change of R: Newton's method with it converges linearly in bending, and diverges in stretching, where most of what
/// is missing, the geometric stiffness, acts.
Mat3 tangent_block(const Body& body, const Stencil& point, std::size_t a, std::size_t b, const Mat3& R);

}  // namespace phyxel::reference::brunet
