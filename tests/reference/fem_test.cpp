#include "reference/fem/solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/fem/solve.h"
#include "support/measured.h"

namespace phyxel::fem {
namespace {

constexpr std::array element_types = {ElementType::tetrahedra, ElementType::hexahedra_8, ElementType::hexahedra_27};
constexpr std::array splits = {Split::six, Split::six_mirrored, Split::six_alternating, Split::five};
constexpr std::array laws = {Law::corotated, Law::saint_venant_kirchhoff, Law::neo_hookean};

const Material rubber = {.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3};

/// Every kind of mesh of a box of `cells`.
std::vector<Mesh> all_meshes(const std::array<std::size_t, 3>& cells, const Vec3& size) {
    std::vector<Mesh> meshes;
    for (const Split split : splits) meshes.push_back(box_mesh(ElementType::tetrahedra, cells, size, split));
    meshes.push_back(box_mesh(ElementType::hexahedra_8, cells, size));
    meshes.push_back(box_mesh(ElementType::hexahedra_27, cells, size));
    return meshes;
}

std::vector<Vec3> random_vectors(std::size_t count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    std::vector<Vec3> v(count);
    for (Vec3& entry : v) entry = {uniform(random), uniform(random), uniform(random)};
    return v;
}

/// Positions turned by one radian and shaken by `shake`.
std::vector<Vec3> turned_and_shaken(const Solid& solid, double shake) {
    const Mat3 Q = rotation_about(normalized(Vec3{1, 2, -1}), 1.0);
    std::vector<Vec3> x = random_vectors(solid.mesh.X.size(), shake, 7);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += Q * solid.mesh.X[i];
    return x;
}

std::vector<Vec3> moved(std::vector<Vec3> x, double factor, const std::vector<Vec3>& direction) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += factor * direction[i];
    return x;
}

/// Interior nodes of the box.
std::vector<bool> interior(const Mesh& mesh) {
    std::vector<bool> inside(mesh.X.size(), true);
    for (const Face face : {Face::x_min, Face::x_max, Face::y_min, Face::y_max, Face::z_min, Face::z_max}) {
        const std::vector<bool> on = nodes_on(mesh, face);
        for (std::size_t i = 0; i < on.size(); ++i)
            if (on[i]) inside[i] = false;
    }
    return inside;
}

TEST(FemMesh, elements_fill_the_box_and_weights_its_faces) {
    for (const Mesh& mesh : all_meshes({2, 3, 4}, {0.2, 0.3, 0.5})) {
        const Solid solid(mesh, rubber);
        double volume = 0, area = 0;
        for (const double V : solid.V) volume += V;
        for (const double weight : face_weights(mesh, Face::y_max)) area += weight;
        EXPECT_NEAR(volume, 0.03, 1e-15);
        EXPECT_NEAR(area, 0.1, 1e-15);
    }
}

TEST(FemMesh, loads_have_the_force_and_the_torque_that_was_asked_for) {
    for (const Mesh& mesh : all_meshes({2, 3, 4}, {0.2, 0.3, 0.5})) {
        const Solid solid(mesh, rubber);
        Conditions conditions(solid);
        add_face_force(conditions, solid, Face::x_max, {1, 2, 3});
        add_gravity(conditions, solid, {0, -10, 0});
        Vec3 force, torque;
        for (std::size_t i = 0; i < mesh.X.size(); ++i) {
            force += conditions.force[i];
            torque += cross(mesh.X[i], conditions.force[i]);
        }
        EXPECT_LT(norm(force - Vec3{1, 2 - 300, 3}), 1e-12);
        const Vec3 face_center = {0.2, 0.15, 0.25}, center = {0.1, 0.15, 0.25};
        EXPECT_LT(norm(torque - cross(face_center, {1, 2, 3}) - cross(center, {0, -300, 0})), 1e-12);
    }
}

TEST(FemMesh, interpolation_reproduces_what_the_shape_functions_span) {
    for (const Mesh& mesh : all_meshes({2, 3, 4}, {0.2, 0.3, 0.5})) {
        const bool quadratic = mesh.type == ElementType::hexahedra_27;
        const auto field = [&](const Vec3& X) {
            return Vec3{1 + X.x - 2 * X.y, X.z, quadratic ? X.x * X.x * X.y : 0.0};
        };
        std::vector<Vec3> values;
        for (const Vec3& X : mesh.X) values.push_back(field(X));
        for (const Vec3& point : {Vec3{0.1, 0.15, 0.5}, Vec3{0.03, 0.22, 0.31}, Vec3{0.2, 0.3, 0.5}, Vec3{}})
            EXPECT_LT(norm(interpolate(mesh, values, point) - field(point)), 1e-14);
    }
}

TEST(FemSolid, forces_are_the_negative_gradient_of_the_energy) {
    double worst = 0;
    for (const Law law : laws)
        for (const Mesh& mesh : all_meshes({2, 1, 1}, {0.2, 0.1, 0.1})) {
            const Solid solid(mesh, with_law(rubber, law));
            const std::vector<Vec3> x = turned_and_shaken(solid, 0.008);
            const std::vector<Vec3> d = random_vectors(x.size(), 1, 3), f = elastic_forces(solid, x);
            double work = 0;
            for (std::size_t i = 0; i < x.size(); ++i) work += dot(f[i], d[i]);

            // Central differences of fourth order.
            const double s = 2e-5;
            const auto U = [&](double factor) { return elastic_energy(solid, moved(x, factor, d)); };
            const double slope = (8 * (U(s) - U(-s)) - (U(2 * s) - U(-2 * s))) / (12 * s);
            worst = std::max(worst, std::abs(slope + work) / std::abs(work));
        }
    measured("relative difference of force and energy's slope", worst);
    EXPECT_LT(worst, 1e-7);
}

TEST(FemSolid, tangent_is_the_derivative_of_the_force) {
    double worst = 0;
    for (const Law law : laws)
        for (const Mesh& mesh : all_meshes({2, 1, 1}, {0.2, 0.1, 0.1})) {
            const Solid solid(mesh, with_law(rubber, law));
            const System system(solid, Conditions(solid));
            const std::vector<Vec3> x = turned_and_shaken(solid, 0.008);
            const std::vector<Vec3> d = random_vectors(x.size(), 1, 3);
            const SparseMatrix K = system.stiffness(x);
            const Eigen::VectorXd action = K.selfadjointView<Eigen::Lower>() * system.gather(d);

            const double s = 2e-5;
            const auto f = [&](double factor) { return system.gather(elastic_forces(solid, moved(x, factor, d))); };
            const Eigen::VectorXd slope = (8 * (f(s) - f(-s)) - (f(2 * s) - f(-2 * s))) / (12 * s);
            worst = std::max(worst, (action + slope).norm() / action.norm());
        }
    measured("relative difference of tangent and force's slope", worst);
    EXPECT_LT(worst, 1e-7);
}

TEST(FemSolid, exerts_no_net_force_and_no_net_torque) {
    for (const Law law : laws)
        for (const Mesh& mesh : all_meshes({2, 1, 1}, {0.2, 0.1, 0.1})) {
            const Solid solid(mesh, with_law(rubber, law));
            const std::vector<Vec3> x = turned_and_shaken(solid, 0.008), f = elastic_forces(solid, x);
            Vec3 force, torque;
            double size = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                force += f[i];
                torque += cross(x[i], f[i]);
                size += norm(f[i]);
            }
            EXPECT_LT(norm(force), 1e-13 * size);
            EXPECT_LT(norm(torque), 1e-13 * size);
        }
}

TEST(FemSolid, rotation_stores_nothing_except_under_the_linear_law) {
    for (const ElementType type : element_types) {
        const Mesh mesh = box_mesh(type, {2, 1, 1}, {0.2, 0.1, 0.1});
        for (const Law law : laws) {
            const Solid solid(mesh, with_law(rubber, law));
            EXPECT_LT(elastic_energy(solid, turned_and_shaken(solid, 0)), 1e-15 * 1e6 * 0.002);  // E V
        }
        const Solid linear_solid(mesh, linear(rubber));
        EXPECT_GT(elastic_energy(linear_solid, turned_and_shaken(linear_solid, 0)), 1);
    }
}

TEST(FemSolid, passes_the_patch_test_on_distorted_elements) {
    const Mat3 G = {{{1.1, 0.1, -0.05}, {0.02, 0.95, 0.08}, {-0.1, 0.03, 1.05}}};
    double worst = 0;
    for (const Law law : laws)
        for (Mesh mesh : all_meshes({3, 3, 3}, {0.3, 0.3, 0.3})) {
            // Inner nodes anywhere, outer nodes held on an affine map: the inner ones must find it.
            const std::vector<bool> inside = interior(mesh);
            const std::vector<Vec3> shake = random_vectors(mesh.X.size(), 0.01, 5);
            for (std::size_t i = 0; i < mesh.X.size(); ++i)
                if (inside[i]) mesh.X[i] += shake[i];
            const Solid solid(mesh, with_law(rubber, law));
            Conditions conditions(solid);
            std::vector<Vec3> start = mesh.X;
            for (std::size_t i = 0; i < start.size(); ++i)
                if (!inside[i]) start[i] = G * start[i];
            for (std::size_t k = 0; k < conditions.fixed.size(); ++k) conditions.fixed[k] = !inside[k / 3];

            const StaticResult result = solve_static(solid, conditions, start);
            ASSERT_TRUE(result.converged) << result.residual;
            for (std::size_t i = 0; i < start.size(); ++i)
                worst = std::max(worst, norm(mesh.X[i] + result.displacement[i] - G * mesh.X[i]) / 0.3);
        }
    measured("largest distance from the affine map, in box sides", worst);
    EXPECT_LT(worst, 1e-9);
}

}  // namespace
}  // namespace phyxel::fem
