#include "approximation/kernel.h"

#include <gtest/gtest.h>

#include "approximation/all_kernels.h"

namespace phyxel {
namespace {

TEST(Kernel, is_one_at_the_point_and_zero_from_the_support_on) {
    for (KernelShape kernel : all_kernels) {
        EXPECT_EQ(weight(kernel, 0), 1);
        EXPECT_NEAR(weight(kernel, 1 - 1e-9), 0, 1e-15);
        for (double s : {1.0, 1.5, 1e9}) {
            EXPECT_EQ(weight(kernel, s), 0);
            EXPECT_EQ(weight_derivative(kernel, s), 0);
        }
    }
}

TEST(Kernel, falls_from_the_point_to_the_support) {
    for (KernelShape kernel : all_kernels)
        for (int k = 1; k < 1000; ++k) {
            EXPECT_LT(weight(kernel, k / 1000.0), weight(kernel, (k - 1) / 1000.0));
            EXPECT_LT(weight_derivative(kernel, k / 1000.0), 0);
        }
}

TEST(Kernel, derivative_is_that_of_the_weight) {
    constexpr double step = 1e-4;
    for (KernelShape kernel : all_kernels)
        for (int k = 1; k < 400; ++k) {
            const double s = (k + 0.5) / 401;  // no difference across the knot of the cubic spline at 1/2
            if (std::abs(s - 0.5) < 3 * step) continue;
            const auto w = [&](double shift) { return weight(kernel, s + shift); };
            const double slope = (8 * (w(step) - w(-step)) - (w(2 * step) - w(-2 * step))) / (12 * step);
            EXPECT_NEAR(weight_derivative(kernel, s), slope, 1e-11);
        }
}

TEST(Kernel, starts_and_ends_without_a_kink) {
    for (KernelShape kernel : all_kernels) {
        EXPECT_EQ(weight_derivative(kernel, 0), 0);
        EXPECT_NEAR(weight_derivative(kernel, 1 - 1e-9), 0, 1e-8);
    }
    EXPECT_NEAR(weight(KernelShape::cubic_spline, 0.5), weight(KernelShape::cubic_spline, 0.5 + 1e-12), 1e-11);
    EXPECT_NEAR(weight_derivative(KernelShape::cubic_spline, 0.5),
                weight_derivative(KernelShape::cubic_spline, 0.5 + 1e-12), 1e-11);
}

}  // namespace
}  // namespace phyxel
