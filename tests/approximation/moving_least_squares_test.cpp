#include "approximation/moving_least_squares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "approximation/all_kernels.h"
#include "geometry/clipping_shapes.h"

namespace phyxel {
namespace {

constexpr double support = 2.2;  // of nodes one apart

/// Nodes of a lattice shaken by a fifth of the spacing, as seen from a point near the middle.
std::vector<Vec3> shaken_lattice() {
    std::mt19937 random(7);
    std::vector<Vec3> nodes;
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j)
            for (int k = -3; k <= 3; ++k)
                nodes.push_back(Vec3{double(i), double(j), double(k)} + 0.2 * random_vector(random));
    return nodes;
}

std::vector<Vec3> seen_from(std::span<const Vec3> nodes, const Vec3& point) {
    std::vector<Vec3> offsets;
    for (const Vec3& X : nodes) offsets.push_back(X - point);
    return offsets;
}

struct LinearErrors {
    double values, gradients;
};

/// Largest violations of sum phi = 1, sum phi X = x, and of sum g = 0, sum X (x) g = I or the projector given.
LinearErrors linear_errors(std::span<const Vec3> offsets, const ShapeFunctions& shape,
                           const Mat3& expected = Mat3::identity()) {
    double sum = 0;
    Vec3 moment, gradient_sum;
    Mat3 spanned;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        sum += shape.phi[i];
        moment += shape.phi[i] * offsets[i];
        gradient_sum += shape.gradient[i];
        spanned += outer(offsets[i], shape.gradient[i]);
    }
    return {std::max(std::abs(sum - 1), norm(moment)), std::max(norm(gradient_sum), norm(spanned - expected))};
}

TEST(MovingLeastSquares, values_and_gradients_are_exact_for_linear_fields) {
    const std::vector<Vec3> nodes = shaken_lattice();
    std::mt19937 random(1);
    for (KernelShape kernel : all_kernels)
        for (int k = 0; k < 50; ++k) {
            const auto offsets = seen_from(nodes, 3 * random_vector(random));  // some at the edge of the cloud
            ShapeFunctions shape;
            MovingLeastSquares(kernel, support).values_and_gradients(offsets, shape);
            EXPECT_EQ(shape.rank, 3);
            EXPECT_LE(linear_errors(offsets, shape).values, 1e-12);
            EXPECT_LE(linear_errors(offsets, shape).gradients, 1e-12);
        }
}

TEST(MovingLeastSquares, gradients_are_the_derivatives_of_the_values) {
    const std::vector<Vec3> nodes = shaken_lattice();
    constexpr double step = 1e-3;
    std::mt19937 random(2);
    for (KernelShape kernel : all_kernels)
        for (int k = 0; k < 20; ++k) {
            const Vec3 point = 2.5 * random_vector(random);
            MovingLeastSquares mls(kernel, support);
            ShapeFunctions shape, moved;
            mls.values_and_gradients(seen_from(nodes, point), shape);
            for (int axis = 0; axis < 3; ++axis) {
                const auto phi = [&](double shift) {
                    Vec3 at = point;
                    at[axis] += shift;
                    mls.values(seen_from(nodes, at), moved);
                    return moved.phi;
                };
                const auto p1 = phi(step), m1 = phi(-step), p2 = phi(2 * step), m2 = phi(-2 * step);
                for (std::size_t i = 0; i < nodes.size(); ++i) {
                    // The cubic spline has a jump in its third derivative, the others one at the support's end.
                    const double slope = (8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12 * step);
                    EXPECT_NEAR(shape.gradient[i][axis], slope, kernel == KernelShape::cubic_spline ? 2e-6 : 1e-7);
                }
            }
        }
}

TEST(MovingLeastSquares, values_alone_are_those_that_come_with_gradients) {
    const auto offsets = seen_from(shaken_lattice(), {0.3, -0.2, 0.1});
    for (KernelShape kernel : all_kernels) {
        ShapeFunctions alone, both;
        MovingLeastSquares(kernel, support).values(offsets, alone);
        MovingLeastSquares(kernel, support).values_and_gradients(offsets, both);
        for (std::size_t i = 0; i < offsets.size(); ++i) EXPECT_NEAR(alone.phi[i], both.phi[i], 1e-15);
    }
}

TEST(MovingLeastSquares, nodal_gradients_are_those_of_the_thesis) {
    const std::vector<Vec3> nodes = shaken_lattice();
    for (std::size_t self : {nodes.size() / 2, std::size_t{0}, nodes.size() - 1}) {
        const auto offsets = seen_from(nodes, nodes[self]);
        ShapeFunctions shape;
        MovingLeastSquares(KernelShape::poly6, support).nodal_gradients(offsets, self, shape);
        EXPECT_LE(linear_errors(offsets, shape).values, 0);
        EXPECT_LE(linear_errors(offsets, shape).gradients, 1e-12);
        Mat3 A;  // Stegmayr 2008, 3.31 and 3.32
        for (const Vec3& X : offsets) A += outer(weight(KernelShape::poly6, norm(X) / support) * X, X);
        for (std::size_t j = 0; j < nodes.size(); ++j) {
            if (j == self) continue;
            const Vec3 expected = inverse(A) * (weight(KernelShape::poly6, norm(offsets[j]) / support) * offsets[j]);
            EXPECT_LE(norm(shape.gradient[j] - expected), 1e-14);
        }
    }
}

/// Nodes on the span of the unit vectors given, and the projector onto it.
struct Flat {
    std::vector<Vec3> nodes;
    Mat3 projector;
    int rank;
};

std::vector<Flat> plane_line_and_lump() {
    const Mat3 Q = rotation_about(normalized(Vec3{1, 2, -1}), 0.7);
    const Vec3 e = Q.column(0), f = Q.column(1);
    Flat plane{{}, outer(e, e) + outer(f, f), 2}, line{{}, outer(e, e), 1}, lump{{{0.1, 0.2, 0.3}}, {}, 0};
    for (int i = -2; i <= 2; ++i) {
        line.nodes.push_back((i + 0.1 * i * i) * e);
        for (int j = -2; j <= 2; ++j) plane.nodes.push_back((i + 0.1 * j) * e + (j + 0.05 * i * i) * f);
    }
    return {plane, line, lump};
}

TEST(MovingLeastSquares, nodes_that_span_no_volume_give_the_projector_onto_what_they_span) {
    for (const Flat& flat : plane_line_and_lump())
        for (KernelShape kernel : all_kernels) {
            const auto offsets = seen_from(flat.nodes, {0.05, 0.02, -0.03});
            ShapeFunctions shape;
            MovingLeastSquares(kernel, 3).values_and_gradients(offsets, shape);
            EXPECT_EQ(shape.rank, flat.rank);
            EXPECT_LE(linear_errors(offsets, shape, flat.projector).gradients, 1e-12) << flat.rank;
            double sum = 0;
            for (double phi : shape.phi) sum += phi;
            EXPECT_NEAR(sum, 1, 1e-13);
        }
}

TEST(MovingLeastSquares, nodal_gradients_in_a_plane_and_a_line_give_the_projector) {
    for (const Flat& flat : plane_line_and_lump()) {
        const std::size_t self = flat.nodes.size() / 2;
        const auto offsets = seen_from(flat.nodes, flat.nodes[self]);
        ShapeFunctions shape;
        MovingLeastSquares(KernelShape::poly6, 3).nodal_gradients(offsets, self, shape);
        EXPECT_EQ(shape.rank, flat.rank);
        EXPECT_LE(linear_errors(offsets, shape, flat.projector).gradients, 1e-12) << flat.rank;
        for (const Vec3& g : shape.gradient) EXPECT_TRUE(is_finite(g));
    }
}

TEST(MovingLeastSquares, scale_of_the_body_cancels) {
    const std::vector<Vec3> nodes = shaken_lattice();
    const auto offsets = seen_from(nodes, {0.3, -0.2, 0.1});
    ShapeFunctions shape, tiny;
    MovingLeastSquares(KernelShape::quartic_spline, support).values_and_gradients(offsets, shape);
    std::vector<Vec3> small = offsets;
    for (Vec3& d : small) d *= 1e-6;
    MovingLeastSquares(KernelShape::quartic_spline, 1e-6 * support).values_and_gradients(small, tiny);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        EXPECT_NEAR(tiny.phi[i], shape.phi[i], 1e-14);
        EXPECT_LE(norm(1e-6 * tiny.gradient[i] - shape.gradient[i]), 1e-13);
    }
}

}  // namespace
}  // namespace phyxel
