#include "approximation/consistency.h"

#include <gtest/gtest.h>

#include <random>

#include "approximation/consistency_bodies.h"
#include "approximation/consistency_fit.h"
#include "approximation/kernel.h"

namespace phyxel {
namespace {

LatticeBody turned_box(double spacing) { return lattice_body(posed(make_box({1, 1, 1}), 3), spacing); }

/// Largest |sum_i d_i| and |sum_i (X_i - X_q) (x) d_i| / h of the changes d of one stencil, over the largest |d|.
double linear_error(const LatticeBody& before, const LatticeBody& after) {
    double error = 0, largest = 0;
    for (std::size_t q = 0; q < before.points.size(); ++q) {
        Vec3 sum;
        Mat3 moment;
        for (std::size_t pair = before.offset[q]; pair < before.offset[q + 1]; ++pair) {
            const Vec3 d = after.gradient[pair] - before.gradient[pair];
            sum += d;
            moment += outer((before.nodes[before.node[pair]] - before.points[q]) / before.support[q], d);
            largest = std::max(largest, norm(d));
        }
        error = std::max({error, norm(sum), norm(moment)});
    }
    return error / largest;
}

double largest_change(const LatticeBody& before, const LatticeBody& after) {
    double change = 0, largest = 0;
    for (std::size_t pair = 0; pair < before.gradient.size(); ++pair) {
        change = std::max(change, norm(after.gradient[pair] - before.gradient[pair]));
        largest = std::max(largest, norm(before.gradient[pair]));
    }
    return change / largest;
}

void expect_patch_test_passes_after_correction(LatticeBody body, double error_without) {
    const LatticeBody before = body;
    EXPECT_GT(before.patch_error(), error_without);
    const ConsistencyReport report = body.correct();
    EXPECT_TRUE(report.converged);
    EXPECT_LT(body.patch_error(), 1e-10);
    EXPECT_LT(report.residual_after, 1e-11);
    EXPECT_LT(report.iterations, 250);
    EXPECT_LT(linear_error(before, body), 1e-12);
    EXPECT_LT(largest_change(before, body), 0.1);
}

TEST(Consistency, constant_stress_leaves_no_force_inside_an_aligned_box) {
    expect_patch_test_passes_after_correction(lattice_body(make_box({1, 1, 1}), 0.1), 1e-3);
}

TEST(Consistency, constant_stress_leaves_no_force_inside_a_turned_box) {
    expect_patch_test_passes_after_correction(turned_box(0.08), 1e-2);
}

TEST(Consistency, constant_stress_leaves_no_force_inside_a_sphere) {
    expect_patch_test_passes_after_correction(lattice_body(make_sphere(0.5), 0.07), 1e-2);
}

TEST(Consistency, constant_stress_leaves_no_force_inside_a_scanned_bunny) {
    const TriangleMesh mesh = posed(bunny(), 5);
    expect_patch_test_passes_after_correction(lattice_body(mesh, body_size(mesh) / 15), 1e-2);
}

TEST(Consistency, size_of_the_body_does_not_matter) {
    for (const double size : {1e-14, 1e14}) {
        LatticeBody body = lattice_body(make_sphere(0.5 * size), 0.1 * size);
        EXPECT_TRUE(body.correct().converged) << size;
        EXPECT_LT(body.patch_error(), 1e-10) << size;
    }
}

TEST(Consistency, strand_of_a_thousand_nodes_is_corrected) {
    const Mat3 turn = rotation_about(normalized(Vec3{1, 2, 3}), 0.4);
    TriangleMesh strand = make_box({150, 1.3, 1.1});
    for (Vec3& X : strand.vertices) X = turn * X;
    expect_patch_test_passes_after_correction(lattice_body(strand, 0.5), 1e-3);
}

TEST(Consistency, bits_do_not_depend_on_the_number_of_threads) {
    const LatticeBody body = turned_box(0.08);
    LatticeBody one = body, two = body, five = body;
    one.correct(1), two.correct(2), five.correct(5);
    EXPECT_TRUE(one.gradient == two.gradient);
    EXPECT_TRUE(one.gradient == five.gradient);
}

TEST(Consistency, parts_that_do_not_touch_are_corrected_as_if_alone) {
    LatticeBody a = turned_box(0.08), b = lattice_body(make_sphere(0.3), 0.1);
    LatticeBody both = side_by_side(a, b);
    EXPECT_TRUE(both.correct().converged);
    EXPECT_LT(both.patch_error(), 1e-10);
    a.correct(), b.correct();
    double difference = 0, largest = 0;
    const LatticeBody apart = side_by_side(a, b);
    for (std::size_t pair = 0; pair < both.gradient.size(); ++pair) {
        difference = std::max(difference, norm(both.gradient[pair] - apart.gradient[pair]));
        largest = std::max(largest, norm(apart.gradient[pair]));
    }
    EXPECT_LT(difference, 1e-9 * largest);
}

TEST(Consistency, consistent_gradients_stay_as_they_are) {
    LatticeBody body = turned_box(0.15);
    body.correct();
    const std::vector<Vec3> gradient = body.gradient;
    const ConsistencyReport report = body.correct();
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_TRUE(body.gradient == gradient);
}

TEST(Consistency, change_is_the_smallest_that_serves) {
    // random changes that keep linear fields, each point its own
    LatticeBody body = turned_box(0.15);
    const std::vector<Vec3> no_force(body.nodes.size());
    const ConsistencyInput input{body.nodes, body.points, body.volumes, body.support, body.offset, body.node, no_force};
    std::mt19937 random(1);
    std::vector<Vec3> some(body.node.size());
    std::vector<double> weights;
    WeightedStencil stencil;
    for (std::size_t q = 0; q < body.points.size(); ++q) {
        stencil.load(input, q);
        const auto d = std::span(some).subspan(body.offset[q], stencil.size());
        for (Vec3& v : d) v = random_vector(random);
        apply_projector(stencil, fit_linear(stencil.position, stencil.weight), d);
        weights.insert(weights.end(), stencil.weight.begin(), stencil.weight.end());
    }

    // the correction does the same to the forces with less: it is at right angles to what it leaves out
    body.gradient.assign(body.node.size(), Vec3{});
    body.surface = no_force;
    for (std::size_t q = 0; q < body.points.size(); ++q)
        for (std::size_t pair = body.offset[q]; pair < body.offset[q + 1]; ++pair)
            body.surface[body.node[pair]] += body.volumes[q] * some[pair];
    body.correct();
    EXPECT_LT(body.patch_error(), 1e-9);
    double size = 0, left_out = 0, product = 0;
    for (std::size_t q = 0; q < body.points.size(); ++q)
        for (std::size_t pair = body.offset[q]; pair < body.offset[q + 1]; ++pair) {
            if (weights[pair] == 0) continue;
            const double factor = body.volumes[q] / weights[pair];
            const Vec3 rest = some[pair] - body.gradient[pair];
            size += factor * norm_squared(body.gradient[pair]);
            left_out += factor * norm_squared(rest);
            product += factor * dot(body.gradient[pair], rest);
        }
    EXPECT_GT(size, 0);
    EXPECT_GT(left_out, size);
    EXPECT_LT(std::abs(product), 1e-9 * (size + left_out));
}

TEST(Consistency, plate_strand_and_lump_are_corrected_within_what_they_span) {
    // nodes in a plane, in a line, and one alone; forces that some change of the gradients can bring about
    LatticeBody body;
    const double h = 2.2;
    const auto add_part = [&](int width, int length, double z) {
        const auto first = static_cast<std::uint32_t>(body.nodes.size());
        for (int i = 0; i < width; ++i)
            for (int j = 0; j < length; ++j) body.nodes.push_back({double(i), double(j), z});
        for (std::uint32_t q = first; q < body.nodes.size(); ++q) {
            body.points.push_back(body.nodes[q]);
            body.volumes.push_back(1);
            body.support.push_back(h);
            for (std::uint32_t i = first; i < body.nodes.size(); ++i)
                if (norm(body.nodes[i] - body.nodes[q]) < h) body.node.push_back(i);
            body.offset.push_back(static_cast<std::uint32_t>(body.node.size()));
        }
    };
    add_part(8, 9, 0), add_part(1, 12, 10), add_part(1, 1, 20);

    std::mt19937 random(2);
    std::vector<Vec3> z(body.nodes.size());
    for (Vec3& v : z) v = random_vector(random);
    body.gradient.resize(body.node.size());
    body.surface.resize(body.nodes.size());
    const ConsistencyInput input{body.nodes, body.points, body.volumes, body.support, body.offset, body.node, z};
    for (std::size_t q = 0; q < body.points.size(); ++q) {
        WeightedStencil stencil;
        stencil.load(input, q);
        std::vector<Vec3> d(stencil.size());
        for (std::size_t i = 0; i < d.size(); ++i) d[i] = z[stencil.node[i]];
        apply_projector(stencil, fit_linear(stencil.position, stencil.weight), d);
        for (std::size_t i = 0; i < d.size(); ++i) body.surface[stencil.node[i]] += d[i];
    }
    const LatticeBody before = body;
    EXPECT_TRUE(body.correct().converged);
    EXPECT_LT(body.patch_error(), 1e-11);
    EXPECT_LT(linear_error(before, body), 1e-12);
}

TEST(Consistency, force_that_no_change_can_balance_is_reported) {
    LatticeBody body = turned_box(0.15);
    for (Vec3& b : body.surface) b += Vec3{1e-4, 0, 0};  // a net force
    const ConsistencyReport report = body.correct();
    EXPECT_FALSE(report.converged);
    EXPECT_LE(report.residual_after, report.residual_before);
    for (const Vec3& g : body.gradient) ASSERT_TRUE(is_finite(g));
}

TEST(Consistency, body_without_points_needs_no_correction) {
    LatticeBody body;
    const ConsistencyReport report = body.correct();
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.zone_nodes, 0u);
}

}  // namespace
}  // namespace phyxel
