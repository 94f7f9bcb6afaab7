#include "surface/embedded_surface.h"

#include <gtest/gtest.h>

#include <limits>

#include "geometry/clipping_shapes.h"
#include "geometry/mesh_check.h"

namespace phyxel {
namespace {

/// A surface on the nodes of the body inside it.
struct Carried {
    explicit Carried(const TriangleMesh& mesh, BodySettings settings = {}) {
        settings.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
        const CheckedMesh checked = check_and_repair(mesh);
        Sampling sampling = sample(checked, settings, spacing_for_count(checked, settings, threads), threads);
        StencilReport report;
        model = build_model(std::move(sampling), settings, threads, report);
        normals = vertex_normals(checked.mesh);
        surface.emplace(model, checked.mesh, normals, threads);
        vertices = checked.mesh.vertices;
    }
    void move(const Mat3& F, const Vec3& shift) {
        std::vector<Vec3> x;
        for (const Vec3& X : model.rest) x.push_back(F * X + shift);
        surface->update(x, threads);
    }

    Threads threads{1};
    Model model;
    std::vector<Vec3> vertices, normals;
    std::optional<EmbeddedSurface> surface;
};

constexpr float epsilon = std::numeric_limits<float>::epsilon();

std::vector<BodySettings> ways_to_sample() {
    BodySettings cubic, turned, bcc, nodal;
    for (BodySettings* s : {&cubic, &turned, &bcc, &nodal}) s->count = 300;
    turned.lattice_rotation = {{1, 2, 3}, 40};
    bcc.lattice = Lattice::bcc;
    nodal.quadrature = Quadrature::nodes;
    return {cubic, turned, bcc, nodal};
}

TEST(EmbeddedSurface, is_the_mesh_at_rest_to_single_precision) {
    for (const BodySettings& settings : ways_to_sample())
        for (const TriangleMesh& mesh : {make_sphere(1), make_box({1, 2, 3}), make_torus(1, 0.4)}) {
            const Carried carried(mesh, settings);
            ASSERT_EQ(carried.surface->positions().size(), carried.vertices.size());
            for (std::size_t v = 0; v < carried.vertices.size(); ++v)
                EXPECT_LT(norm(vector_cast<double>(carried.surface->positions()[v]) - carried.vertices[v]),
                          3 * epsilon);
        }
}

TEST(EmbeddedSurface, follows_affine_motion_exactly) {
    const Mat3 F = {{{1.2, 0.3, -0.1}, {0.2, 0.7, 0.4}, {-0.3, 0.1, 1.1}}};
    const Vec3 shift{0.5, -1, 2};
    for (const BodySettings& settings : ways_to_sample()) {
        Carried carried(make_torus(1, 0.4), settings);
        carried.move(F, shift);
        for (std::size_t v = 0; v < carried.vertices.size(); ++v) {
            const Vec3 expected = F * carried.vertices[v] + shift;
            EXPECT_LT(norm(vector_cast<double>(carried.surface->positions()[v]) - expected), 4 * epsilon);
        }
    }
}

TEST(EmbeddedSurface, turns_normals_by_the_cofactor_of_the_deformation_gradient) {
    const Mat3 F = {{{1.2, 0.3, -0.1}, {0.2, 0.7, 0.4}, {-0.3, 0.1, 1.1}}};
    for (const BodySettings& settings : ways_to_sample()) {
        Carried carried(make_torus(1, 0.4), settings);
        carried.move(F, {});
        for (std::size_t v = 0; v < carried.normals.size(); ++v) {
            const Vec3 expected = normalized(cofactor(F) * carried.normals[v]);
            EXPECT_LT(norm(vector_cast<double>(carried.surface->normals()[v]) - expected), 4 * epsilon);
        }
    }
}

TEST(EmbeddedSurface, keeps_unit_normals_where_the_body_is_squashed_flat) {
    Carried carried(make_sphere(1), ways_to_sample().front());
    carried.move({}, {1, 2, 3});
    for (const Vec3f& n : carried.surface->normals()) EXPECT_NEAR(norm(n), 1, 4 * epsilon);
}

TEST(VertexNormals, are_outward_unit_vectors) {
    const TriangleMesh sphere = make_sphere(2);
    const std::vector<Vec3> normals = vertex_normals(sphere);
    for (std::size_t v = 0; v < normals.size(); ++v) EXPECT_GT(dot(normals[v], normalized(sphere.vertices[v])), 0.99);
    TriangleMesh loose = sphere;
    loose.vertices.push_back({9, 9, 9});
    EXPECT_EQ(vertex_normals(loose).back(), Vec3{});
}

}  // namespace
}  // namespace phyxel
