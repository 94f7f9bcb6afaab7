#include "sampling/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "phyxel/error.h"
#include "sampling/sampled.h"
#include "support/measured.h"
#include "support/two_threads.h"

namespace phyxel {
namespace {

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// How far the nearest node plane is from the coordinate, in pitches.
double off_plane(double coordinate, double pitch) {
    return std::abs(coordinate / pitch - std::round(coordinate / pitch));
}

TEST(Sampling, box_whose_sides_the_spacing_divides_has_nodes_on_its_faces) {
    const Sampling s = sampled(make_box({1, 0.8, 0.6}), {}, 0.2);
    EXPECT_EQ(s.nodes.size(), 6u * 5 * 4);
    EXPECT_EQ(s.points.size(), 8u * 5 * 4 * 3);
    Vec3 low = s.frame.to_rest(s.nodes[0]), high = low;
    for (const Vec3& p : s.nodes)
        for (std::size_t c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], s.frame.to_rest(p)[c]);
            high[c] = std::max(high[c], s.frame.to_rest(p)[c]);
        }
    EXPECT_LE(norm(low - Vec3{-0.5, -0.4, -0.3}), 1e-15);
    EXPECT_LE(norm(high - Vec3{0.5, 0.4, 0.3}), 1e-15);
}

TEST(Sampling, box_whose_sides_wobble_by_rounding_or_one_in_a_hundred_thousand_still_fits) {
    for (const double wobble : {0.0, 1e-15, 1e-6, -1e-6}) {
        const Sampling s = sampled(make_box({1 + wobble, 0.8, 0.6 - wobble}), {}, 0.2);
        EXPECT_EQ(s.nodes.size(), 6u * 5 * 4) << wobble;
    }
    // A box that was turned lies on its own lattice.
    BodySettings settings;
    settings.rotation = {{1, 2, 3}, 71};
    const Mat3 R = rotation_matrix(settings.rotation);
    const Sampling s = sampled(transformed(make_box({1, 0.8, 0.6}), R, {5, -7, 3}), settings, 0.2);
    EXPECT_EQ(s.nodes.size(), 6u * 5 * 4);
    EXPECT_EQ(s.points.size(), 8u * 5 * 4 * 3);
}

TEST(Sampling, nodes_overhang_both_faces_alike_where_the_spacing_does_not_divide_the_side) {
    const Sampling s = sampled(make_box({1, 1, 1}), {}, 0.3);
    double low = 1, high = -1;
    for (const Vec3& p : s.nodes)
        low = std::min(low, s.frame.to_rest(p).x), high = std::max(high, s.frame.to_rest(p).x);
    EXPECT_NEAR(low, -high, 1e-15);
    EXPECT_GT(s.nodes.size(), 27u);
}

TEST(Sampling, spacing_is_exact) {
    for (const double spacing : {0.1, 0.123, 0.2}) {
        const Sampling cubic = sampled(make_sphere(0.5), {}, spacing);
        BodySettings settings;
        settings.lattice = Lattice::bcc;
        const Sampling bcc = sampled(make_sphere(0.5), settings, spacing);
        const auto nearest = [](const Sampling& s) {
            double distance = 1e9;
            for (std::size_t n = 1; n < s.nodes.size(); ++n)
                distance = std::min(distance, norm(s.nodes[n] - s.nodes[0]));
            return distance;
        };
        EXPECT_NEAR(nearest(cubic), spacing, 1e-15);
        EXPECT_NEAR(nearest(bcc), std::sqrt(0.75) * spacing, 1e-15);
        EXPECT_NEAR(double(bcc.nodes.size()) / double(cubic.nodes.size()), 2, 0.35);
    }
}

TEST(Sampling, count_is_met_within_three_percent) {
    double worst = 0;
    for (const Scheme& scheme : all_schemes())
        for (const auto& [name, mesh] : patch_bodies())
            for (const std::size_t count : {300u, 2000u}) {
                BodySettings settings = turned(settings_of(scheme));
                settings.count = count;
                const CheckedMesh checked = check_and_repair(mesh);
                const double spacing = spacing_for_count(checked, settings, threads);
                const Sampling s = sample(checked, settings, spacing, threads);
                const double error = double(s.nodes.size()) / double(count) - 1;
                EXPECT_LE(std::abs(error), 0.03) << scheme.name << ", " << name << ", " << count;
                worst = std::max(worst, std::abs(error));
            }
    measured("count", worst);
}

TEST(Sampling, count_is_met_within_three_percent_on_aligned_boxes_where_the_lattice_allows_it) {
    // A box on its own lattice jumps from n^3 to (n + 1)^3 nodes as faces fall on planes.
    BodySettings settings;
    settings.count = 1000;
    const CheckedMesh box = check_and_repair(make_box({1, 1, 1}));
    const Sampling s = sample(box, settings, spacing_for_count(box, settings, threads), threads);
    EXPECT_LE(std::abs(double(s.nodes.size()) / 1000 - 1), 0.35);
    measured("count on an aligned cube", double(s.nodes.size()) / 1000 - 1);
}

TEST(Sampling, volumes_add_up_to_that_of_the_mesh_and_first_moments_with_eight_points_a_cell) {
    double worst = 0;
    for (const Scheme& scheme : all_schemes())
        for (const auto& [name, mesh] : patch_bodies())
            for (const bool aligned : {true, false}) {
                const BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
                const Sampling s = sampled(mesh, settings, equal_spacing(scheme, 0.11));
                const VolumeMoments exact = volume_moments(mesh);
                EXPECT_NEAR(sum(s.volumes) / exact.volume, 1, 1e-12) << scheme.name << ", " << name;
                EXPECT_NEAR(s.clipped_volume / exact.volume, 1, 1e-12) << scheme.name << ", " << name;
                worst = std::max(worst, std::abs(sum(s.volumes) / exact.volume - 1));
                for (double V : s.volumes) ASSERT_GT(V, 0) << scheme.name << ", " << name;
                Vec3 closed;
                for (const SurfacePoint& b : s.boundary) closed += b.area;
                EXPECT_LE(norm(closed), 1e-12) << scheme.name << ", " << name;
            }
    measured("volume", worst);
}

TEST(Sampling, whole_octants_carry_gauss_points_and_clipped_ones_their_centroid) {
    const double a = 0.11, inset = 0.5 - 0.5 / std::sqrt(3.0);
    const Sampling s = sampled(make_sphere(0.5), turned({}), a);
    const double whole = a * a * a / 8;
    std::size_t gauss = 0;
    for (std::size_t q = 0; q < s.points.size(); ++q) {
        if (std::abs(s.volumes[q] / whole - 1) > 1e-9) {
            EXPECT_EQ(s.point_kind[q], Sampling::irregular);
            continue;
        }
        ++gauss;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(off_plane(s.points[q][c], a), inset, 1e-12);
    }
    EXPECT_GT(gauss, s.points.size() / 3);
    // First moments: Gauss points come in eights about the middle of a lattice cell, so in a box of whole cells they
    // keep the centroid.
    const Sampling box = sampled(make_box({1, 0.8, 0.6}), {}, 0.2);
    Vec3 moment;
    for (std::size_t q = 0; q < box.points.size(); ++q) moment += box.volumes[q] * box.frame.to_rest(box.points[q]);
    EXPECT_LE(norm(moment), 1e-15);
}

TEST(Sampling, slivers_give_their_volume_to_a_neighbor) {
    // Aligned faces a thousandth of an octant behind a node plane: a layer of slivers.
    BodySettings settings;
    settings.lattice_offset = {0.4998, 0, 0};
    for (const auto& [mesh, expected] : {std::pair{make_box({1, 0.8, 0.6}), true}, {make_sphere(0.5), true}}) {
        const Sampling s = sampled(mesh, settings, 0.2);
        EXPECT_EQ(s.merged_octants > 0, expected);
        for (double V : s.volumes) EXPECT_GE(V, 1e-3 * 0.2 * 0.2 * 0.2 / 8);
        EXPECT_NEAR(sum(s.volumes) / volume_moments(mesh).volume, 1, 1e-12);
    }
}

TEST(Sampling, every_node_stands_in_a_cell_that_is_filled) {
    for (const Scheme& scheme : all_schemes()) {
        const Sampling s = sampled(unit_bunny(), turned(settings_of(scheme)), equal_spacing(scheme, 0.1));
        std::set<std::array<double, 3>> places;
        for (std::size_t n = 0; n < s.nodes.size(); ++n) {
            places.insert({s.nodes[n].x, s.nodes[n].y, s.nodes[n].z});
            const auto& held = s.cell_nodes[s.node_cell[n]];
            EXPECT_TRUE(held[0] == n || held[1] == n) << scheme.name;
            for (std::size_t c = 0; c < 3; ++c) {
                const double steps = s.nodes[n][c] / s.pitch - (scheme.lattice == Lattice::bcc ? 0.5 : 0);
                EXPECT_NEAR(steps, std::round(steps), 1e-9) << scheme.name;
            }
        }
        EXPECT_GT(places.size(), s.nodes.size() * 9 / 10) << scheme.name;
    }
}

TEST(Sampling, lattice_turns_and_shifts_as_told) {
    BodySettings settings;
    settings.rotation = {{0, 0, 1}, 20};
    settings.lattice_rotation = {{0, 0, 1}, 25};
    const TriangleMesh mesh = transformed(make_sphere(0.5), rotation_matrix(settings.rotation), {});
    const Sampling s = sampled(mesh, settings, 0.2);
    EXPECT_LE(norm(s.frame.rotation - rotation_about({0, 0, 1}, std::acos(-1) / 4)), 1e-15);
    settings.lattice_offset = {0.5, 0.25, -0.1};
    const Sampling shifted = sampled(mesh, settings, 0.2);
    EXPECT_LE(norm(shifted.frame.origin - s.frame.origin - s.frame.rotation * Vec3{0.1, 0.05, -0.02}), 1e-15);
    EXPECT_NEAR(sum(shifted.volumes), sum(s.volumes), 1e-12);
}

TEST(Sampling, is_the_same_for_any_number_of_threads) {
    for (const Scheme& scheme : all_schemes()) {
        const BodySettings settings = turned(settings_of(scheme));
        const Sampling one = sampled(unit_bunny(), settings, equal_spacing(scheme, 0.1), 1);
        for (const int count : {2, 3, 8}) {
            const Sampling s = sampled(unit_bunny(), settings, equal_spacing(scheme, 0.1), count);
            EXPECT_TRUE(s.nodes == one.nodes && s.points == one.points && s.volumes == one.volumes) << scheme.name;
            EXPECT_TRUE(s.neighbors == one.neighbors && s.boundary_cell == one.boundary_cell) << scheme.name;
        }
    }
}

TEST(Sampling, whole_cells_are_the_bodies_of_the_thesis) {
    const Sampling s = whole_cells({3, 4, 5}, 0.1);
    EXPECT_EQ(s.nodes.size(), 60u);
    EXPECT_EQ(s.points, s.nodes);
    EXPECT_NEAR(s.clipped_volume, 60 * 1e-3, 1e-15);
    EXPECT_NEAR(sum(s.node_volumes), s.clipped_volume, 1e-15);
    for (std::size_t n = 0; n < s.nodes.size(); ++n) EXPECT_EQ(s.point_node[n], n);
}

/// What `sample` says when it refuses; empty when it does not.
std::string refusal(const CheckedMesh& mesh, const BodySettings& settings, double spacing) {
    try {
        sample(mesh, settings, spacing, threads);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/// The number after "Use a spacing of".
double recommended(const std::string& message) {
    const std::string words = "se a spacing of ";
    const std::size_t at = message.find(words);
    return at == std::string::npos ? 0 : std::stod(message.substr(at + words.size()));
}

TEST(Refusals, name_a_spacing_that_works) {
    const std::vector<std::pair<std::string, TriangleMesh>> bodies = {{"cube", make_box({1, 1, 1})},
                                                                      {"plate", make_box({1, 1, 0.02})},
                                                                      {"needle", make_box({2, 0.05, 0.05})},
                                                                      {"sphere", make_sphere(0.5)},
                                                                      {"bunny", unit_bunny()}};
    for (const auto& [name, mesh] : bodies) {
        const CheckedMesh checked = check_and_repair(mesh);
        for (const Scheme& scheme : all_schemes())
            for (const double spacing : {1e9, 100.0, 3.0}) {
                const std::string message = refusal(checked, settings_of(scheme), spacing);
                if (message.empty()) continue;  // four nodes around a corner of the lattice are a body
                const double workable = recommended(message);
                ASSERT_GT(workable, 0) << message;
                EXPECT_EQ(refusal(checked, settings_of(scheme), workable), "")
                    << scheme.name << ", " << name << " at " << spacing << ": " << message;
            }
    }
}

TEST(Refusals, body_in_a_single_cell_is_refused) {
    for (const Scheme& scheme : all_schemes())
        for (const double spacing : {1e9, 100.0}) {
            BodySettings settings = settings_of(scheme);
            settings.lattice_offset = {0.3, 0.3, 0.3};
            const std::string message = refusal(check_and_repair(make_box({1, 1, 1})), settings, spacing);
            EXPECT_NE(message, "") << scheme.name << " at " << spacing;
        }
}

TEST(Refusals, nodes_in_one_plane_are_refused) {
    BodySettings settings;
    settings.lattice_offset = {0, 0, 0.5};
    const std::string message = refusal(check_and_repair(make_box({1, 1, 0.1})), settings, 0.25);
    EXPECT_NE(message.find("all in one plane"), std::string::npos) << message;
    EXPECT_EQ(refusal(check_and_repair(make_box({1, 1, 0.1})), settings, recommended(message)), "") << message;
}

TEST(Refusals, spacing_beyond_memory_is_refused_at_once_with_one_that_fits) {
    const std::string message = refusal(check_and_repair(make_box({1, 1, 1})), {}, 1e-7);
    EXPECT_NE(message.find("more than memory holds"), std::string::npos) << message;
    const double workable = recommended(message);
    EXPECT_GT(workable, 1e-4) << message;
    EXPECT_LT(workable, 0.05) << message;
    BodySettings settings;
    settings.count = 1000000000000;
    const CheckedMesh box = check_and_repair(make_box({1, 1, 1}));
    EXPECT_THROW(spacing_for_count(box, settings, threads), Error);
}

}  // namespace
}  // namespace phyxel
