#include "geometry/mesh_check.h"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/clipping_shapes.h"
#include "geometry/mesh_measure.h"
#include "geometry/winding_volume.h"

using namespace phyxel;
using std::numbers::pi;

namespace {

TriangleMesh scaled(TriangleMesh mesh, double by) {
    for (Vec3& x : mesh.vertices) x *= by;
    return mesh;
}

/// The triangles whose centroid satisfies `keep`.
template <class Keep>
TriangleMesh only(TriangleMesh mesh, Keep&& keep) {
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return !keep((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0);
    });
    return mesh;
}

/// A band of `quads` quadrilaterals around the y axis, of the given radius and width; twisted half around or not.
TriangleMesh band(std::uint32_t quads, bool moebius) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < quads; ++i) {
        const double u = 2 * pi * i / quads, v = moebius ? u / 2 : pi / 2;
        for (const double s : {-0.3, 0.3}) {
            const double distance = 1 + s * std::cos(v);
            mesh.vertices.push_back({distance * std::cos(u), s * std::sin(v), distance * std::sin(u)});
        }
    }
    for (std::uint32_t i = 0; i < quads; ++i) {
        std::uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % quads), d = c + 1;
        if (moebius && i + 1 == quads) std::swap(c, d);
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
    }
    return mesh;
}

bool mentions(const std::vector<std::string>& sentences, const std::string& word) {
    for (const std::string& s : sentences)
        if (s.find(word) != std::string::npos) return true;
    return false;
}

}  // namespace

TEST(MeshCheck, clean_shapes_are_closed_and_simple_with_their_genus_and_exact_volume) {
    const auto expect = [](const TriangleMesh& mesh, long genus, double volume) {
        const CheckedMesh checked = check_and_repair(mesh);
        const MeshReport& r = checked.report;
        EXPECT_TRUE(checked.closed_and_simple);
        EXPECT_TRUE(r.can_be_simulated) << r.refusal;
        EXPECT_TRUE(r.closed() && r.manifold() && r.oriented());
        EXPECT_EQ(r.genus, genus);
        EXPECT_EQ(r.components, 1u);
        EXPECT_EQ(r.self_intersections, 0u);
        EXPECT_TRUE(r.repairs.empty());
        EXPECT_NEAR(r.volume / volume, 1, 1e-12);
        EXPECT_EQ(checked.mesh.triangles, mesh.triangles);
        EXPECT_EQ(checked.mesh.vertices, mesh.vertices);
    };
    expect(make_box({1, 2, 3}), 0, 6);
    expect(make_box({1, 2, 1e-4}), 0, 2e-4);
    expect(make_sphere(0.1), 0, 4 * pi / 3 * 1e-3);
    expect(make_torus(2, 0.5), 1, 2 * pi * pi * 2 * 0.25);
    expect(moved(make_cylinder(1, 2), {100, 200, 300}), 0, 2 * pi);
}

TEST(MeshCheck, seams_are_welded) {
    // Every triangle with vertices of its own, some a rounding error away, as after a texture export
    const TriangleMesh sphere = make_sphere(1);
    TriangleMesh soup;
    for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
        for (const std::uint32_t v : sphere.triangles[t]) {
            const double error = t % 3 ? 0 : 1e-11;
            soup.vertices.push_back(sphere.vertices[v] + Vec3{error, -error, error});
        }
    for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    const CheckedMesh checked = check_and_repair(soup);
    EXPECT_EQ(checked.mesh.vertices.size(), sphere.vertices.size());
    EXPECT_EQ(checked.report.duplicate_vertices, soup.vertices.size() - sphere.vertices.size());
    EXPECT_TRUE(checked.closed_and_simple);
    for (std::size_t v = 0; v < soup.vertices.size(); ++v)
        EXPECT_LT(norm(checked.mesh.vertices[checked.vertex_of[v]] - soup.vertices[v]), 1e-8);
}

TEST(MeshCheck, useless_vertices_and_triangles_are_dropped_and_counted) {
    TriangleMesh box = make_box({1, 1, 1});
    const std::size_t triangles = box.triangles.size();
    box.vertices.push_back({1e30, 0, 0});  // used by no triangle: not even looked at
    const auto [a, b, c] = box.triangles[0];
    box.triangles.push_back({a, a, b});
    box.triangles.push_back({b, c, a});
    const CheckedMesh checked = check_and_repair(box);
    EXPECT_EQ(checked.report.unused_vertices, 1u);
    EXPECT_EQ(checked.report.degenerate_triangles, 1u);
    EXPECT_EQ(checked.report.duplicate_triangles, 1u);
    EXPECT_EQ(checked.mesh.triangles.size(), triangles);
    EXPECT_TRUE(checked.closed_and_simple);
    EXPECT_EQ(checked.report.repairs.size(), 3u);
}

TEST(MeshCheck, vertices_of_dropped_triangles_alone_are_dropped_with_them) {
    TriangleMesh box = make_box({1, 1, 1});
    const std::size_t vertices = box.vertices.size();
    const auto ghost = static_cast<std::uint32_t>(vertices);
    box.vertices.insert(box.vertices.begin(), {0, 3, 0});
    for (Triangle& t : box.triangles)
        for (std::uint32_t& v : t) ++v;
    box.triangles.insert(box.triangles.begin(), {0, 0, ghost});
    const CheckedMesh checked = check_and_repair(box);
    EXPECT_EQ(checked.report.unused_vertices, 1u);
    EXPECT_EQ(checked.mesh.vertices.size(), vertices);
    EXPECT_EQ(checked.vertex_of[0], UINT32_MAX);
    for (std::size_t v = 1; v <= vertices; ++v) EXPECT_EQ(checked.mesh.vertices[checked.vertex_of[v]], box.vertices[v]);
    EXPECT_TRUE(checked.closed_and_simple);
}

TEST(MeshCheck, triangles_are_turned_to_agree) {
    TriangleMesh sphere = make_sphere(1);
    for (std::size_t t = 0; t < sphere.triangles.size(); t += 7)
        std::swap(sphere.triangles[t][0], sphere.triangles[t][1]);
    const CheckedMesh checked = check_and_repair(sphere);
    EXPECT_EQ(checked.report.flipped_triangles, (sphere.triangles.size() + 6) / 7);
    EXPECT_FALSE(checked.report.inside_out);
    EXPECT_TRUE(checked.closed_and_simple);
    EXPECT_NEAR(signed_volume(checked.mesh), 4 * pi / 3, 1e-12);
}

TEST(MeshCheck, body_inside_out_as_a_whole_is_turned) {
    const CheckedMesh checked = check_and_repair(inverted(make_sphere(1)));
    EXPECT_TRUE(checked.report.inside_out);
    EXPECT_TRUE(checked.report.can_be_simulated);
    EXPECT_TRUE(checked.closed_and_simple);
    EXPECT_NEAR(checked.report.signed_volume, 4 * pi / 3, 1e-12);
    EXPECT_TRUE(mentions(checked.report.repairs, "inside out"));
}

TEST(MeshCheck, cavity_stays_a_cavity_also_when_the_whole_is_inside_out) {
    const TriangleMesh hollow = joined(make_sphere(1), inverted(moved(make_sphere(0.5), {0.2, 0, 0})));
    for (const TriangleMesh& mesh : {hollow, inverted(hollow)}) {
        const CheckedMesh checked = check_and_repair(mesh);
        EXPECT_TRUE(checked.closed_and_simple);
        EXPECT_EQ(checked.report.components, 2u);
        EXPECT_NEAR(checked.report.volume, 4 * pi / 3 * 0.875, 1e-12);
        EXPECT_NEAR(signed_volume(checked.mesh), 4 * pi / 3 * 0.875, 1e-12);
    }
}

TEST(MeshCheck, one_of_two_bodies_inside_out_is_turned_alone) {
    const CheckedMesh checked = check_and_repair(joined(make_sphere(1), inverted(moved(make_sphere(0.5), {3, 0, 0}))));
    EXPECT_TRUE(checked.closed_and_simple);
    EXPECT_NEAR(checked.report.volume, 4 * pi / 3 * 1.125, 1e-12);
}

TEST(MeshCheck, solid_within_a_solid_counts_once) {
    const CheckedMesh checked = check_and_repair(joined(make_sphere(1), make_sphere(0.5)));
    EXPECT_TRUE(checked.report.can_be_simulated);
    EXPECT_FALSE(checked.closed_and_simple);
    EXPECT_NEAR(checked.report.volume / (4 * pi / 3), 1, 0.005);
}

TEST(MeshCheck, overlap_counts_once) {
    const CheckedMesh checked = check_and_repair(joined(make_sphere(1), moved(make_sphere(1), {1, 0, 0})));
    const MeshReport& r = checked.report;
    EXPECT_TRUE(r.can_be_simulated) << r.refusal;
    EXPECT_FALSE(checked.closed_and_simple);
    EXPECT_GT(r.self_intersections, 50u);
    EXPECT_EQ(r.intersection_places.size(), 16u);
    for (const Vec3& x : r.intersection_places) EXPECT_NEAR(x.x, 0.5, 0.1);
    const double lens = 2 * pi / 3 * 0.25 * 2.5;  // two caps of height 1/2: pi h^2 (3 - h) / 3 each
    EXPECT_NEAR(r.volume / (8 * pi / 3 - lens), 1, 0.005);
}

TEST(MeshCheck, sphere_without_every_fiftieth_triangle_is_accepted_with_its_volume) {
    TriangleMesh sphere = make_sphere(1);
    for (std::size_t t = sphere.triangles.size(); t-- > 0;)
        if (t % 50 == 0) sphere.triangles.erase(sphere.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    const MeshReport r = check_mesh(sphere);
    EXPECT_TRUE(r.can_be_simulated) << r.refusal;
    EXPECT_FALSE(r.closed());
    EXPECT_GT(r.holes, 90u);
    EXPECT_EQ(r.hole_places.size(), 16u);
    EXPECT_NEAR(r.volume / (4 * pi / 3), 1, 0.005);
    EXPECT_TRUE(mentions(r.repairs, "holes closed"));
}

TEST(MeshCheck, half_a_sphere_is_closed_by_the_plane_of_its_rim) {
    const MeshReport r = check_mesh(only(make_sphere(1), [](const Vec3& x) { return x.y > 0; }));
    EXPECT_TRUE(r.can_be_simulated) << r.refusal;
    EXPECT_EQ(r.holes, 1u);
    EXPECT_NEAR(r.hole_places[0].y, 0, 0.05);
    EXPECT_NEAR(r.volume / (2 * pi / 3), 1, 0.03);
}

TEST(MeshCheck, shallow_dome_is_refused_with_its_rim_as_the_place) {
    const MeshReport r = check_mesh(only(make_sphere(1), [](const Vec3& x) { return x.y > 0.8; }));
    EXPECT_FALSE(r.can_be_simulated);
    EXPECT_NE(r.refusal.find("hole around ("), std::string::npos) << r.refusal;
    EXPECT_NE(r.refusal.find("close"), std::string::npos);
}

TEST(MeshCheck, surfaces_without_an_inside_are_refused) {
    TriangleMesh sheet = only(make_box({1, 1, 1}), [](const Vec3& x) { return x.y > 0.499; });
    TriangleMesh triangle;
    triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.triangles = {{0, 1, 2}};
    TriangleMesh point = triangle;
    point.vertices = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    TriangleMesh line = triangle;
    line.vertices = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    TriangleMesh flat_box = make_box({1, 1, 1});
    for (Vec3& x : flat_box.vertices) x.y = 0;
    TriangleMesh both_sides = joined(sheet, inverted(sheet));
    for (const TriangleMesh& mesh :
         {sheet, triangle, point, line, flat_box, both_sides, band(60, true), band(60, false)}) {
        const MeshReport r = check_mesh(mesh);
        EXPECT_FALSE(r.can_be_simulated);
        EXPECT_NE(r.refusal.find('('), std::string::npos) << "names a place: " << r.refusal;
        EXPECT_TRUE(std::isfinite(r.volume) && std::isfinite(r.area));
    }
    EXPECT_GT(check_mesh(band(60, true)).inconsistent_edges, 0u);
}

TEST(MeshCheck, numbers_that_cannot_be_worked_with_are_refused_and_never_nan) {
    const TriangleMesh box = make_box({1, 1, 1});
    std::vector<TriangleMesh> meshes = {{},
                                        scaled(box, 1e30),
                                        scaled(box, 1e150),
                                        scaled(box, 1e-30),
                                        scaled(box, 1e-150),
                                        moved(box, {1e12, 0, 0}),
                                        box,
                                        box,
                                        box};
    meshes[6].vertices[3].x = NAN;
    meshes[7].vertices[3].y = -INFINITY;
    meshes[8].triangles[5][1] = 1u << 31;
    meshes.push_back(box);
    meshes.back().vertices[4].z = 1e30;
    for (const TriangleMesh& mesh : meshes) {
        const MeshReport r = check_mesh(mesh);
        EXPECT_FALSE(r.can_be_simulated);
        EXPECT_FALSE(r.refusal.empty());
        EXPECT_EQ(r.volume, 0);
    }
    EXPECT_NE(check_mesh(meshes.back()).refusal.find("vertex 4"), std::string::npos);
}

TEST(MeshCheck, size_does_not_matter_within_sixteen_decades) {
    for (const double scale : {1e-8, 1e-4, 1e4, 1e8}) {
        const CheckedMesh checked = check_and_repair(scaled(make_sphere(1), scale));
        EXPECT_TRUE(checked.closed_and_simple) << scale;
        const MeshReport overlap = check_mesh(scaled(joined(make_sphere(1), moved(make_sphere(1), {1, 0, 0})), scale));
        EXPECT_TRUE(overlap.can_be_simulated) << scale << overlap.refusal;
    }
}

TEST(MeshCheck, bodies_that_share_a_vertex_or_an_edge_stay_simple) {
    TriangleMesh box = make_box({1, 1, 1});
    const CheckedMesh at_vertex = check_and_repair(joined(box, moved(box, {1, 1, 1})));
    EXPECT_TRUE(at_vertex.closed_and_simple);
    EXPECT_EQ(at_vertex.report.nonmanifold_vertices, 1u);
    EXPECT_EQ(at_vertex.report.nonmanifold_edges, 0u);
    EXPECT_NEAR(at_vertex.report.volume, 2, 1e-12);

    const CheckedMesh at_edge = check_and_repair(joined(box, inverted(moved(box, {1, 1, 0}))));
    EXPECT_EQ(at_edge.report.nonmanifold_edges, 16u);
    EXPECT_TRUE(at_edge.report.can_be_simulated);
    EXPECT_NEAR(at_edge.report.volume, 2, 0.02);
}

TEST(WindingVolume, of_a_closed_round_body_is_exact_to_one_percent) {
    for (const TriangleMesh& mesh : {make_sphere(1), make_torus(2, 0.5), moved(make_cylinder(1, 1), {3, 4, 5})}) {
        const WindingVolume measured = winding_volume(mesh, WindingNumber(mesh));
        EXPECT_NEAR(measured.volume / signed_volume(mesh), 1, 0.01);
        EXPECT_EQ(measured.doubtful, 0);
    }
}
