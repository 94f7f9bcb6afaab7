#include "bench/table_5_1.h"

#include <gtest/gtest.h>

#include <cmath>

namespace phyxel::bench {
namespace {

/// Mean number of nodes within the support, the node itself included, counted pair by pair.
double counted_neighbors(const TableBody& body) {
    const double spacing = 0.1, h = support(body, spacing);
    const std::vector<Vec3> X = positions(body, spacing);
    std::size_t pairs = 0;
    for (const Vec3& center : X)
        for (const Vec3& other : X) pairs += norm(other - center) < h ? 1 : 0;
    return double(pairs) / double(X.size());
}

TEST(Table51, node_counts_are_those_of_the_thesis) {
    const std::size_t printed[] = {48, 100, 180, 294, 448, 448, 1210};
    for (std::size_t i = 0; i < table_5_1.size(); ++i) {
        EXPECT_EQ(node_count(table_5_1[i]), printed[i]);
        EXPECT_EQ(positions(table_5_1[i], 1).size(), printed[i]);
    }
}

TEST(Table51, neighbor_counts_are_as_tabulated_and_within_four_percent_of_the_thesis) {
    for (const TableBody& body : table_5_1) {
        EXPECT_NEAR(counted_neighbors(body), body.mean_neighbors, 1e-12) << node_count(body);
        EXPECT_NEAR(body.mean_neighbors / body.thesis_neighbors, 1, 0.04) << node_count(body);
    }
}

TEST(Table51, no_other_shell_comes_nearer_to_the_thesis) {
    for (const TableBody& body : table_5_1) {
        const double chosen = std::abs(body.mean_neighbors - body.thesis_neighbors);
        for (const int step : {-1, 1}) {
            TableBody other = body;
            while (counted_neighbors(other) == body.mean_neighbors) other.shell_squared += step;
            EXPECT_GT(std::abs(counted_neighbors(other) - body.thesis_neighbors), chosen) << node_count(body);
        }
    }
}

}  // namespace
}  // namespace phyxel::bench
