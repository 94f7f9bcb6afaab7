/// Manufactured solutions: a smooth field is chosen, the law says which forces keep it in equilibrium, and the static
/// solver has to find it again. Bodies are curved and turned against the lattice, so that all of their surface is
/// clipped; what is prescribed is prescribed on the surface itself, as displacements through patch averages and as
/// tractions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "solver/dynamics.h"
#include "solver/statics.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

/// A body, the displacement that it shall find, and what holds a part of its surface: there that displacement is that
/// of the grip at time 1.
struct Problem {
    TriangleMesh mesh;
    std::function<Vec3(const Vec3&)> u;  ///< [m] at rest points
    Fix held;
    BoxSelection loaded;  ///< the rest of the surface carries tractions
};

/// Derivative by coordinate d, of sixth order; f smooth on the scale of metres.
template <class Field>
auto derivative(const Field& f, const Vec3& X, std::size_t d) {
    constexpr double h = 0.01;
    const auto odd = [&](double k) {
        Vec3 forward = X, backward = X;
        forward[d] += k * h, backward[d] -= k * h;
        return f(forward) - f(backward);
    };
    return (1 / h) * (0.75 * odd(1) - 0.15 * odd(2) + 1.0 / 60 * odd(3));
}

/// F = I + du/dX
Mat3 exact_gradient(const Problem& problem, const Vec3& X) {
    Mat3 F = Mat3::identity();
    for (std::size_t d = 0; d < 3; ++d) {
        const Vec3 column = derivative(problem.u, X, d);
        for (std::size_t k = 0; k < 3; ++k) F(k, d) += column[k];
    }
    return F;
}

/// -div P(F) [N/m^3]: what must act on every volume.
Vec3 body_force(const Problem& problem, const MaterialPoint& material, const Vec3& X) {
    Vec3 b;
    for (std::size_t d = 0; d < 3; ++d) {
        const Mat3 change =
            derivative([&](const Vec3& Y) { return stress(material, exact_gradient(problem, Y)); }, X, d);
        for (std::size_t k = 0; k < 3; ++k) b[k] -= change(k, d);
    }
    return b;
}

/// Shape functions at the quadrature points.
EmbeddedPoints at_points(const Model& m) {
    return embed(m.sampling, m.approximation, m.sampling.points, m.sampling.point_cell, Gradients::no, threads);
}

void add_force(const EmbeddedPoints& points, std::size_t p, const Vec3& force, std::vector<Vec3>& f) {
    for (std::uint32_t k = points.offset[p]; k < points.offset[p + 1]; ++k) f[points.node[k]] += points.phi[k] * force;
}

/// Body forces by the quadrature of the volume, tractions by that of the surface.
std::vector<Vec3> exact_forces(const Problem& problem, const Model& m, const EmbeddedPoints& points) {
    std::vector<Vec3> f(m.rest.size());
    const LatticeFrame& frame = m.sampling.frame;
    for (std::size_t q = 0; q < points.size(); ++q)
        add_force(points, q, m.volumes[q] * body_force(problem, m.material, frame.to_rest(m.sampling.points[q])), f);
    const SurfaceSelection surface = select_surface(m, problem.mesh, problem.loaded);
    const EmbeddedPoints pieces =
        embed(m.sampling, m.approximation, surface.position, surface.cell, Gradients::no, threads);
    for (std::size_t s = 0; s < pieces.size(); ++s) {
        const Vec3 X = frame.to_rest(surface.position[s]);
        const Vec3 area = frame.direction_to_rest(surface.area[s]);
        add_force(pieces, s, stress(m.material, exact_gradient(problem, X)) * area, f);
    }
    return f;
}

/// Differences from the exact solution, root mean square over the volume against that of the solution itself.
struct Errors {
    double displacement = 0, strain = 0;
};

Errors solve(const Problem& problem, const BodySettings& settings, double spacing) {
    const auto body = body_of(modelled(problem.mesh, settings, spacing));
    const Model& m = body->model;
    body->constraints.add(m, problem.mesh, problem.held, threads);
    const EmbeddedPoints points = at_points(m);
    body->loads.emplace_back(exact_forces(problem, m, points));
    const SolveReport report = find_equilibrium(*body, {}, 0, 1, threads);
    EXPECT_TRUE(report.converged) << report.trouble;

    const std::vector<Mat3> F = deformation_gradients(m, body->state.x, threads);
    double moved = 0, strained = 0;
    Errors errors;
    for (std::size_t q = 0; q < points.size(); ++q) {
        const Vec3 X = m.sampling.frame.to_rest(m.sampling.points[q]), u = problem.u(X);
        const Mat3 exact = exact_gradient(problem, X);
        const auto square = [](const Mat3& A) { return norm(A) * norm(A); };
        const auto strain = [](const Mat3& G) { return 0.5 * (transpose(G) * G - Mat3::identity()); };
        const Vec3 missed = points.position(q, body->state.x) - X - u;
        errors.displacement += m.volumes[q] * dot(missed, missed);
        moved += m.volumes[q] * dot(u, u);
        errors.strain += m.volumes[q] * square(strain(F[q]) - strain(exact));
        strained += m.volumes[q] * square(strain(exact));
    }
    return {std::sqrt(errors.displacement / moved), std::sqrt(errors.strain / strained)};
}

/// Solves at spacings that shrink, and expects errors that shrink with the given powers of them.
void expect_orders(const Problem& problem, Law law, const std::vector<double>& spacings) {
    BodySettings settings = turned(settings_of(all_schemes()[0]));
    settings.material.law = law;
    std::vector<Errors> errors;
    for (double spacing : spacings) {
        errors.push_back(solve(problem, settings, spacing));
        measured("displacement at " + std::to_string(spacing), errors.back().displacement);
        measured("strain at " + std::to_string(spacing), errors.back().strain);
    }
    const double refinement = std::log(spacings.front() / spacings.back());
    const double displacement = std::log(errors.front().displacement / errors.back().displacement) / refinement;
    const double strain = std::log(errors.front().strain / errors.back().strain) / refinement;
    measured("order of displacement", displacement);
    measured("order of strain", strain);
    EXPECT_GE(displacement, 1.8);
    EXPECT_GE(strain, 0.9);
}

constexpr double far = 9;  ///< [m] beyond all bodies

/// Twenty times the field of the SOFA plugin Caribou, u_k = 1e-3 z exp(x_k), its z our height above the held face.
Problem cylinder() {
    constexpr double foot = -1.5, above = foot + 1e-6;
    const auto u = [](const Vec3& X) {
        return 0.02 * (X.y - foot) * Vec3{std::exp(X.x), std::exp(X.y), std::exp(X.z)};
    };
    return {make_cylinder(1, 3),
            u,
            {.box = {{-far, -far, -far}, {far, above, far}}},
            {{-far, above, -far}, {far, far, far}}};
}

/// The cylinder with its solution turned and shifted as a whole, as the grip at its foot takes it: stresses turn with
/// it, so that the forces are others.
Problem gripped_cylinder() {
    Problem problem = cylinder();
    Fix& grip = problem.held;
    grip.axis = {0.2, -1, 0.5}, grip.center = {0.3, 0.4, -0.2};
    grip.path = {{}, {.time = 1, .displacement = {0.4, 0.3, -0.5}, .degrees = 20}};
    problem.u = [u = problem.u, motion = GripMotion(grip)](const Vec3& X) { return motion.place(X + u(X), 1) - X; };
    return problem;
}

/// Half a metre around a ring of one, so fine that its triangles are the surface.
TriangleMesh fine_torus() {
    constexpr std::uint32_t around = 288, along = 144;
    TriangleMesh mesh;
    for (std::uint32_t k = 0; k < around; ++k)
        for (std::uint32_t j = 0; j < along; ++j) {
            const double u = 2 * std::numbers::pi * k / around, v = 2 * std::numbers::pi * j / along;
            const double distance = 1 + 0.5 * std::cos(v);
            mesh.vertices.push_back({distance * std::cos(u), 0.5 * std::sin(v), -distance * std::sin(u)});
            const std::uint32_t next = (k + 1) % around * along, above = (j + 1) % along;
            mesh.triangles.push_back({k * along + j, next + j, next + above});
            mesh.triangles.push_back({k * along + j, next + above, k * along + above});
        }
    return mesh;
}

/// Zero on the whole surface, which is held where x < -0.3.
Problem torus() {
    const auto u = [](const Vec3& X) {
        const double ring = std::hypot(X.x, X.z) - 1, depth = 0.25 - ring * ring - X.y * X.y;
        return 0.04 * depth * Vec3{std::cos(X.y), std::sin(X.x + X.z), std::exp(0.3 * X.y)};
    };
    return {fine_torus(), u, {.box = {{-far, -far, -far}, {-0.3, far, far}}}, {{-0.3, -far, -far}, {far, far, far}}};
}

TEST(ManufacturedSolution, of_a_cylinder_is_found) { expect_orders(cylinder(), Law::neo_hookean, {0.5, 0.3}); }

TEST(ManufacturedSolution, of_a_gripped_cylinder_is_found) {
    expect_orders(gripped_cylinder(), Law::neo_hookean, {0.5, 0.3});
}

// Orders 2.0 to 2.2 and 1.5.
TEST(ManufacturedSolution, LONG_of_a_cylinder_is_found_over_three_refinements) {
    for (Law law : {Law::linear, Law::corotated, Law::neo_hookean})
        expect_orders(cylinder(), law, {0.5, 0.4, 0.3, 0.2});
}

// Orders 2.0 to 2.1 and 1.5.
TEST(ManufacturedSolution, LONG_of_a_gripped_cylinder_is_found_over_three_refinements) {
    for (Law law : {Law::corotated, Law::neo_hookean}) expect_orders(gripped_cylinder(), law, {0.5, 0.4, 0.3, 0.2});
}

// Orders 1.8 to 1.9 and 1.5: what is held is held through the means of its patches.
TEST(ManufacturedSolution, LONG_of_a_torus_is_found_over_three_refinements) {
    for (Law law : {Law::neo_hookean, Law::corotated}) expect_orders(torus(), law, {0.25, 0.2, 0.15, 0.11});
}

}  // namespace
}  // namespace phyxel
