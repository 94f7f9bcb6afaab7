#include "approximation/stencils.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "approximation/embedded_points.h"
#include "approximation/moving_least_squares.h"
#include "approximation/support_search.h"
#include "sampling/sampled.h"
#include "support/measured.h"

namespace phyxel {
namespace {

ApproximationSettings approximation_of(const BodySettings& settings, double spacing, bool corrected = true) {
    return {.kernel = kernel_shape(settings),
            .support = support_radius(settings, spacing),
            .nodal_gradients = settings.quadrature == Quadrature::nodes,
            .consistency_correction = corrected};
}

/// A sampling in the order of its stencils, and the stencils.
struct Built {
    Sampling sampling;
    StencilBuild build;

    /// [pairs] node and gradient of point q.
    template <class Visit>
    void visit_pairs(std::uint32_t q, const Stencils::Block& block, Visit&& visit) const {
        const Stencils& st = build.stencils;
        for (std::uint32_t k = st.offset[q], g = st.gradient_begin[q]; k < st.offset[q + 1]; ++k, ++g)
            visit(st.slot_node[block.slot_begin + st.local[k]], st.gradient[g]);
    }
    template <class Visit>
    void visit_points(Visit&& visit) const {
        for (const auto& block : build.stencils.blocks)
            for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) visit(q, block);
    }
};

Built built(const TriangleMesh& mesh, const BodySettings& settings, double spacing, bool corrected = true,
            int threads = 2) {
    Built b{sampled(mesh, settings, spacing), {}};
    b.build = build_stencils(b.sampling, approximation_of(settings, spacing, corrected), Threads(threads));
    return b;
}

/// Largest |sum_i g| h and |sum_i X_i (x) g - I| of any stencil.
double linear_error(const Built& b, double h) {
    double error = 0;
    b.visit_points([&](std::uint32_t q, const Stencils::Block& block) {
        Vec3 sum;
        Mat3 spanned;
        b.visit_pairs(q, block, [&](std::uint32_t node, const Vec3& g) {
            sum += g;
            spanned += outer(b.sampling.frame.direction_to_rest(b.sampling.nodes[node] - b.sampling.points[q]), g);
        });
        error = std::max({error, h * norm(sum), norm(spanned - Mat3::identity())});
    });
    return error;
}

TEST(Stencils, are_exact_for_linear_fields_after_the_correction) {
    double worst = 0;
    for (const Scheme& scheme : all_schemes())
        for (auto& [name, mesh] : patch_bodies())
            for (const bool aligned : {true, false}) {
                const BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
                const double spacing = equal_spacing(scheme, 0.16);
                const Built b = built(mesh, settings, spacing);
                EXPECT_TRUE(b.build.report.consistent) << scheme.name << " " << name;
                EXPECT_EQ(b.build.report.deficient, 0u) << scheme.name << " " << name;
                EXPECT_GT(b.build.report.consistency_before, 1e-4) << scheme.name << " " << name;
                const double error = linear_error(b, support_radius(settings, spacing));
                EXPECT_LE(error, 1e-12) << scheme.name << " " << name << (aligned ? " aligned" : " turned");
                worst = std::max(worst, error);
            }
    measured("linear fields", worst);
}

TEST(Stencils, of_any_kernel_are_exact_for_linear_fields) {
    for (const KernelShape kernel :
         {KernelShape::quartic_spline, KernelShape::poly6, KernelShape::cubic_spline, KernelShape::wendland})
        for (const Scheme& scheme : all_schemes()) {
            BodySettings settings = turned(settings_of(scheme));
            settings.kernel.shape = kernel;
            const Built b = built(make_sphere(0.5), settings, equal_spacing(scheme, 0.25));
            EXPECT_LE(linear_error(b, 0.5), 1e-12) << scheme.name;
        }
}

TEST(Stencils, from_templates_equal_those_built_one_by_one) {
    for (const Scheme& scheme : all_schemes()) {
        BodySettings settings = settings_of(scheme);
        settings.rotation = {{1, 2, -1}, 40};  // the lattice turns with the body
        const double spacing = equal_spacing(scheme, 0.1);
        const ApproximationSettings approximation = approximation_of(settings, spacing);
        const TriangleMesh mesh =
            transformed(make_box({1.2, 1.2, 1.2}), rotation_matrix(settings.rotation), {0.1, 0.2, 0.3});
        const Built b = built(mesh, settings, spacing, false);
        SupportSearch search(b.sampling);
        Support support;
        ShapeFunctions shape;
        std::map<std::uint32_t, std::size_t> uses;
        for (std::uint32_t begin : b.build.stencils.gradient_begin) ++uses[begin];
        std::size_t shared = 0;
        double worst = 0;
        b.visit_points([&](std::uint32_t q, const Stencils::Block& block) {
            if (uses[b.build.stencils.gradient_begin[q]] == 1) return;
            ++shared;
            find_support(search, b.sampling, approximation.kernel, approximation.support, b.sampling.points[q],
                         b.sampling.point_cell[q], support);
            MovingLeastSquares mls(approximation.kernel, support.radius);
            const auto self = std::find(support.nodes.begin(), support.nodes.end(), b.sampling.point_node[q]);
            if (self != support.nodes.end())
                mls.nodal_gradients(support.offsets, static_cast<std::size_t>(self - support.nodes.begin()), shape);
            else mls.values_and_gradients(support.offsets, shape);
            std::map<std::uint32_t, Vec3> expected;
            for (std::size_t i = 0; i < support.nodes.size(); ++i)
                expected[support.nodes[i]] = b.sampling.frame.direction_to_rest(shape.gradient[i]);
            std::size_t pairs = 0;
            b.visit_pairs(q, block, [&](std::uint32_t node, const Vec3& g) {
                ASSERT_EQ(expected.count(node), 1u) << scheme.name;
                worst = std::max(worst, norm(g - expected[node]) * approximation.support);
                ++pairs;
            });
            EXPECT_EQ(pairs, expected.size()) << scheme.name;
        });
        EXPECT_GT(shared, b.sampling.points.size() / 20) << scheme.name;
        EXPECT_LE(worst, 1e-13) << scheme.name;
        measured(scheme.name + ", share of points with a template", double(shared) / double(b.sampling.points.size()));
    }
}

TEST(Stencils, share_out_the_whole_volume_and_only_positive_shares) {
    for (const Scheme& scheme : all_schemes()) {
        const Built b = built(unit_bunny(), turned(settings_of(scheme)), equal_spacing(scheme, 0.125));
        double sum = 0;
        for (double V : b.build.node_volumes) {
            EXPECT_GE(V, 0) << scheme.name;
            sum += V;
        }
        EXPECT_NEAR(sum / b.sampling.clipped_volume, 1, 1e-13) << scheme.name;
    }
}

TEST(Stencils, slots_list_each_node_of_a_block_once_and_each_node_its_slots) {
    const Built b = built(unit_bunny(), settings_of(all_schemes()[0]), 0.1);
    const Stencils& st = b.build.stencils;
    std::uint32_t points = 0, slots = 0;
    for (const auto& block : st.blocks) {
        EXPECT_EQ(block.point_begin, points);
        EXPECT_EQ(block.slot_begin, slots);
        points = block.point_end, slots = block.slot_end;
        const std::set<std::uint32_t> nodes(st.slot_node.begin() + block.slot_begin,
                                            st.slot_node.begin() + block.slot_end);
        EXPECT_EQ(nodes.size(), block.slot_end - block.slot_begin);
    }
    EXPECT_EQ(points, st.points());
    EXPECT_EQ(slots, st.slot_node.size());
    for (std::uint32_t n = 0; n < b.sampling.nodes.size(); ++n)
        for (std::uint32_t k = st.node_slot_offset[n]; k < st.node_slot_offset[n + 1]; ++k)
            EXPECT_EQ(st.slot_node[st.node_slots[k]], n);
    EXPECT_EQ(st.node_slot_offset.back(), st.slot_node.size());
}

TEST(Stencils, are_the_same_bits_for_any_number_of_threads) {
    for (const Scheme& scheme : all_schemes()) {
        const BodySettings settings = turned(settings_of(scheme));
        const double spacing = equal_spacing(scheme, 0.16);
        const Built one = built(unit_bunny(), settings, spacing, true, 1);
        for (const int count : {2, 3, 8}) {
            const Built b = built(unit_bunny(), settings, spacing, true, count);
            EXPECT_TRUE(b.build.stencils.gradient == one.build.stencils.gradient) << scheme.name << " " << count;
            EXPECT_TRUE(b.build.stencils.local == one.build.stencils.local) << scheme.name << " " << count;
            EXPECT_TRUE(b.build.node_volumes == one.build.node_volumes) << scheme.name << " " << count;
        }
    }
}

TEST(Stencils, support_comes_from_spacings_or_from_the_nearest_nodes) {
    BodySettings settings;
    EXPECT_DOUBLE_EQ(support_radius(settings, 0.5), 1.1);
    settings.quadrature = Quadrature::nodes;
    EXPECT_DOUBLE_EQ(support_radius(settings, 0.5), 0.9);
    settings.kernel.support = 3;
    EXPECT_DOUBLE_EQ(support_radius(settings, 0.5), 1.5);
    settings.kernel.neighbors = 18, settings.kernel.dilation = 1.5;  // six at 1, twelve at sqrt(2)
    EXPECT_NEAR(support_radius(settings, 0.5), 0.5 * 1.5 * (6 + 12 * std::sqrt(2)) / 18, 1e-15);
    settings.lattice = Lattice::bcc, settings.kernel.neighbors = 14;  // eight at sqrt(3)/2, six at 1
    EXPECT_NEAR(support_radius(settings, 0.5), 0.5 * 1.5 * (8 * std::sqrt(0.75) + 6) / 14, 1e-15);
}

TEST(Stencils, widened_supports_are_counted_and_hold_eight_nodes) {
    BodySettings settings = turned(settings_of(all_schemes()[0]));
    settings.kernel.support = 1.2;
    const Built b = built(make_sphere(0.5), settings, 0.2);
    std::size_t wide = 0;
    for (float share : b.build.stencils.support) wide += share > 1;
    EXPECT_GT(wide, 0u);
    EXPECT_EQ(b.build.report.widened, wide);
    b.visit_points([&](std::uint32_t q, const Stencils::Block&) {
        EXPECT_GE(b.build.stencils.offset[q + 1] - b.build.stencils.offset[q], 8u);
    });
    settings.kernel.support = 0;
    EXPECT_EQ(built(make_box({1, 1, 1}), settings_of(all_schemes()[0]), 0.2).build.report.widened, 0u);
}

/// A block with a plate thinner than a spacing standing off to the side of it, too far away to lend it nodes.
TEST(Stencils, points_whose_nodes_span_no_volume_are_counted_with_a_place) {
    const TriangleMesh mesh =
        joined(make_box({1, 1, 1}), transformed(make_box({1, 1, 0.02}), Mat3::identity(), {0, 0, 5.05}));
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.lattice == Lattice::bcc) continue;  // its two nodes a box do not lie in one plane
        const Built b = built(mesh, settings_of(scheme), 0.25);
        EXPECT_GT(b.build.report.deficient, 10u) << scheme.name;
        EXPECT_NEAR(b.build.report.deficient_place.z, 5.05, 0.1) << scheme.name;
        for (const Vec3& g : b.build.stencils.gradient) ASSERT_TRUE(is_finite(g)) << scheme.name;
    }
}

/// Two plates with `gap` between them, the lower one's top at z = 0.
TriangleMesh two_plates(double thickness, double gap) {
    return joined(transformed(make_box({1, 1, thickness}), Mat3::identity(), {0, 0, -thickness / 2}),
                  transformed(make_box({1, 1, thickness}), Mat3::identity(), {0, 0, gap + thickness / 2}));
}

/// [cells] the lowest cell that the solid joins each one to.
std::vector<std::uint32_t> joined_cells(const Sampling& s) {
    std::vector<std::uint32_t> first(s.cell_box.size());
    for (std::uint32_t c = 0; c < first.size(); ++c) first[c] = c;
    for (bool changed = true; changed;) {
        changed = false;
        for (std::uint32_t c = 0; c < first.size(); ++c)
            for (std::uint32_t k = s.neighbor_offset[c]; k < s.neighbor_offset[c + 1]; ++k)
                if (first[s.neighbors[k]] < first[c]) first[c] = first[s.neighbors[k]], changed = true;
    }
    return first;
}

TEST(SupportSearch, does_not_cross_a_gap_of_a_quarter_spacing) {
    constexpr double a = 0.125;
    for (const Scheme& scheme : all_schemes())
        for (const bool aligned : {true, false}) {
            const BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
            const std::string name = scheme.name + (aligned ? ", aligned" : ", turned");
            const Built b = built(two_plates(0.3, a / 4), settings, equal_spacing(scheme, a), false);
            const std::vector<std::uint32_t> part = joined_cells(b.sampling);
            EXPECT_EQ(std::set(part.begin(), part.end()).size(), 2u) << name;

            std::vector<std::set<std::uint32_t>> parts_of_node(b.sampling.nodes.size());
            double volume = 0, misplaced = 0;
            const auto centroid = [&](std::uint32_t c) {
                return b.sampling.frame.to_rest(b.sampling.cell_centroids[c]);
            };
            const bool first_is_below = centroid(part[0]).z < a / 8;
            b.visit_points([&](std::uint32_t q, const Stencils::Block& block) {
                const std::uint32_t cell = b.sampling.point_cell[q];
                b.visit_pairs(q, block,
                              [&](std::uint32_t node, const Vec3&) { parts_of_node[node].insert(part[cell]); });
                volume += b.sampling.volumes[q];
                if ((centroid(cell).z < a / 8) != (first_is_below == (part[cell] == part[0])))
                    misplaced += b.sampling.volumes[q];
            });
            for (const auto& parts : parts_of_node) EXPECT_EQ(parts.size(), 1u) << name;
            // Slivers of both plates in one octant go to one of them, and such a cell may be the one that names a
            // node's.
            EXPECT_LE(misplaced, 1e-3 * volume) << name;
            measured(name + ", share of volume on the wrong side", misplaced / volume);
        }
}

TEST(SupportSearch, finds_every_node_within_reach_of_a_body_without_gaps) {
    const BodySettings settings = turned(settings_of(all_schemes()[0]));
    const Sampling s = sampled(make_box({1, 1, 1}), settings, 0.125);
    SupportSearch search(s);
    const double h = 2.2 * 0.125;
    for (std::uint32_t q = 0; q < s.points.size(); q += 17) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t n = 0; n < s.nodes.size(); ++n)
            if (norm(s.nodes[n] - s.points[q]) < h * (1 - 1e-9)) expected.push_back(n);
        EXPECT_EQ(search.find(s.points[q], s.point_cell[q], h), expected) << q;
    }
}

TEST(EmbeddedPoints, reproduce_linear_fields_and_their_gradients) {
    for (const Scheme& scheme : all_schemes()) {
        const BodySettings settings = turned(settings_of(scheme));
        const double spacing = equal_spacing(scheme, 0.125);
        const Sampling s = sampled(unit_bunny(), settings, spacing);
        std::vector<Vec3> positions, nodes;
        for (const SurfacePoint& p : s.boundary) positions.push_back(p.position);
        const Mat3 F = {{{1.2, 0.3, 0}, {0, 0.9, 0.1}, {-0.2, 0, 1.1}}};
        for (const Vec3& X : s.nodes) nodes.push_back(F * s.frame.to_rest(X));
        const EmbeddedPoints points =
            embed(s, approximation_of(settings, spacing), positions, s.boundary_cell, Gradients::yes, Threads(2));
        double worst = 0;
        for (std::size_t p = 0; p < points.size(); ++p)
            worst = std::max({worst, norm(points.position(p, nodes) - F * s.frame.to_rest(positions[p])),
                              norm(points.deformation_gradient(p, nodes) - F)});
        EXPECT_LE(worst, 1e-12) << scheme.name;
    }
}

}  // namespace
}  // namespace phyxel
