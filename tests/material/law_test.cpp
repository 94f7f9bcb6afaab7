#include "material/law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace phyxel {
namespace {

class Draw {
public:
    explicit Draw(unsigned seed) : random_(seed) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    Mat3 matrix() {
        Mat3 A;
        for (Vec3& row : A.rows) row = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        return A;
    }
    Mat3 rotation() {
        const Vec3 axis = normalized(Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
        return rotation_about(axis, uniform(0, std::numbers::pi));
    }

private:
    std::mt19937 random_;
};

/// A law under test with its name for messages.
struct Case {
    std::string name;
    MaterialPoint material;
};

Case make_case(std::string name, Law law, double poissons_ratio = 0.3, double volume_stiffness = 0) {
    return {std::move(name), material_point({.density = 1000,
                                             .youngs_modulus = 2e4,
                                             .poissons_ratio = poissons_ratio,
                                             .law = law,
                                             .volume_stiffness = volume_stiffness})};
}

std::vector<Case> all_laws() {
    return {make_case("linear", Law::linear),
            make_case("saint_venant_kirchhoff", Law::saint_venant_kirchhoff),
            make_case("saint_venant_kirchhoff_with_volume_force", Law::saint_venant_kirchhoff, 0.3, 3e4),
            make_case("corotated", Law::corotated),
            make_case("corotated_nearly_incompressible", Law::corotated, 0.49),
            make_case("neo_hookean", Law::neo_hookean),
            make_case("neo_hookean_nearly_incompressible", Law::neo_hookean, 0.49),
            make_case("neo_hookean_auxetic", Law::neo_hookean, -0.4)};
}

/// Rotated, sheared and stretched gradients; every third one turned inside out.
std::vector<Mat3> gradients() {
    Draw draw(4);
    std::vector<Mat3> all;
    for (int i = 0; i < 300; ++i) {
        const Mat3 Q = draw.rotation();
        Vec3 stretch = {draw.uniform(0.4, 1.8), draw.uniform(0.4, 1.8), draw.uniform(0.4, 1.8)};
        // Inside out: the sums with the other stretches stay above 0.2, so that the rotation is differentiable.
        if (i % 3 == 2) stretch.x = -0.5 * std::min({stretch.x, stretch.y, stretch.z});
        all.push_back(draw.rotation() * Q * Mat3::diagonal(stretch) * transpose(Q));
    }
    return all;
}

/// Central difference of fourth order: error of order step^4.
template <class Function>
auto derivative(const Function& function, double step) {
    const auto near = function(step) - function(-step), far = function(2 * step) - function(-2 * step);
    return (8 * near - far) * (1 / (12 * step));
}

TEST(Law, stress_is_the_derivative_of_energy) {
    for (const auto& [name, material] : all_laws()) {
        double worst = 0;
        for (const Mat3& F : gradients()) {
            const Mat3 P = stress(material, F);
            Mat3 difference;
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c)
                    difference(r, c) = derivative(
                        [&](double s) {
                            Mat3 shifted = F;
                            shifted(r, c) += s;
                            return energy(material, shifted);
                        },
                        1e-3);
            worst = std::max(worst, norm(P - difference) / norm(P));
        }
        EXPECT_LE(worst, 1e-7) << name;
    }
}

TEST(Law, stress_action_is_the_derivative_of_stress) {
    Draw draw(5);
    for (const auto& [name, material] : all_laws()) {
        double worst = 0;
        for (const Mat3& F : gradients()) {
            const Mat3 dF = draw.matrix();
            const Mat3 difference = derivative([&](double s) { return stress(material, F + s * dF); }, 3e-4);
            const Mat3 dP = stress_action(material, F, dF);
            worst = std::max(worst, norm(dP - difference) / norm(dP));
        }
        EXPECT_LE(worst, 1e-7) << name;
    }
}

TEST(Law, dilatation_gradient_and_its_action_are_derivatives) {
    Draw draw(11);
    for (const auto& [name, material] : all_laws()) {
        double worst = 0, worst_action = 0;
        for (const Mat3& F : gradients()) {
            const Law law = material.law;
            const Mat3 dF = draw.matrix();
            const double slope = derivative([&](double s) { return dilatation(law, F + s * dF); }, 3e-4);
            worst = std::max(worst, std::abs(contract(dilatation_gradient(law, F), dF) - slope));
            const Mat3 change = derivative([&](double s) { return dilatation_gradient(law, F + s * dF); }, 3e-4);
            worst_action = std::max(worst_action, norm(dilatation_gradient_action(law, F, dF) - change) / norm(dF));
        }
        EXPECT_LE(worst, 1e-9) << name;
        EXPECT_LE(worst_action, 1e-7) << name;
    }
}

TEST(Law, energy_is_that_without_dilatation_and_half_lambda_times_dilatation_squared) {
    for (const auto& [name, material] : all_laws())
        for (const Mat3& F : gradients()) {
            const double lambda = material.lame.lambda, theta = dilatation(material.law, F);
            const double sum = energy(without_dilatation(material), F) + 0.5 * lambda * theta * theta;
            EXPECT_NEAR(energy(material, F), sum, 1e-12 * (p_wave_modulus(material.lame) + std::abs(sum))) << name;
        }
}

TEST(Law, stress_action_is_symmetric) {
    Draw draw(6);
    for (const auto& [name, material] : all_laws())
        for (const Mat3& F : gradients()) {
            const Mat3 A = draw.matrix(), B = draw.matrix();
            const Mat3 dA = stress_action(material, F, A), dB = stress_action(material, F, B);
            EXPECT_NEAR(contract(A, dB), contract(B, dA), 1e-13 * (norm(A) * norm(dB) + norm(B) * norm(dA))) << name;
        }
}

TEST(Law, energy_and_stress_turn_with_the_body_except_for_the_linear_law) {
    Draw draw(7);
    for (const auto& [name, material] : all_laws()) {
        double worst_stress = 0, worst_energy = 0;
        for (const Mat3& F : gradients()) {
            const Mat3 Q = draw.rotation(), P = stress(material, F);
            const double scale = norm(P) + p_wave_modulus(material.lame);
            worst_stress = std::max(worst_stress, norm(stress(material, Q * F) - Q * P) / scale);
            worst_energy = std::max(worst_energy, std::abs(energy(material, Q * F) - energy(material, F)) / scale);
        }
        if (material.law == Law::linear) {
            EXPECT_GT(worst_stress, 0.1) << name;
            EXPECT_GT(worst_energy, 0.1) << name;
        } else {
            EXPECT_LE(worst_stress, 1e-13) << name;
            EXPECT_LE(worst_energy, 1e-13) << name;
        }
    }
}

TEST(Law, cauchy_stress_is_symmetric_except_for_the_linear_law) {
    for (const auto& [name, material] : all_laws()) {
        if (material.law == Law::linear) continue;
        for (const Mat3& F : gradients()) {
            const Mat3 sigma = cauchy_stress(F, stress(material, F));
            EXPECT_LE(norm(sigma - transpose(sigma)), 1e-12 * (norm(sigma) + p_wave_modulus(material.lame))) << name;
        }
    }
}

TEST(Law, rest_stores_and_pulls_nothing) {
    for (const auto& [name, material] : all_laws()) {
        EXPECT_EQ(energy(material, Mat3::identity()), 0) << name;
        EXPECT_EQ(norm(stress(material, Mat3::identity())), 0) << name;
    }
}

TEST(Law, rigid_rotation_stores_and_pulls_nothing_except_for_the_linear_law) {
    Draw draw(8);
    for (const auto& [name, material] : all_laws()) {
        if (material.law == Law::linear) continue;
        for (int i = 0; i < 100; ++i) {
            const Mat3 R = draw.rotation();
            EXPECT_LE(std::abs(energy(material, R)), 1e-15 * p_wave_modulus(material.lame)) << name;
            EXPECT_LE(norm(stress(material, R)), 1e-14 * p_wave_modulus(material.lame)) << name;
        }
    }
}

TEST(Law, small_strain_is_hooke_for_every_law) {
    Draw draw(9);
    for (const auto& [name, material] : all_laws()) {
        for (int i = 0; i < 50; ++i) {
            const Mat3 dF = draw.matrix();
            Mat3 hooke = material.lame.mu * (dF + transpose(dF)) + material.lame.lambda * trace(dF) * Mat3::identity();
            hooke += material.volume_stiffness * trace(dF) * Mat3::identity();  // k_v adds to lambda
            EXPECT_LE(norm(stress_action(material, Mat3::identity(), dF) - hooke), 1e-14 * norm(hooke)) << name;
        }
    }
}

TEST(Law, small_energies_keep_their_digits) {
    const Mat3 strain = {{{2, 1, 0}, {1, -1, 0.5}, {0, 0.5, 1}}};
    for (const auto& [name, material] : all_laws()) {
        const double trace_squared = trace(strain) * trace(strain);
        const double hooke = material.lame.mu * contract(strain, strain) +
                             0.5 * (material.lame.lambda + material.volume_stiffness) * trace_squared;
        EXPECT_NEAR(energy(material, Mat3::identity() + 1e-7 * strain) / (1e-14 * hooke), 1, 2e-6) << name;
    }
}

TEST(Law, young_and_poisson_are_what_a_bar_shows) {
    const double E = 2e4, nu = 0.3, strain = 1e-6;
    for (const auto& [name, material] :
         {make_case("linear", Law::linear, nu), make_case("corotated", Law::corotated, nu),
          make_case("neo_hookean", Law::neo_hookean, nu), make_case("green", Law::saint_venant_kirchhoff, nu)}) {
        const Mat3 P = stress(material, Mat3::diagonal({1 + strain, 1 - nu * strain, 1 - nu * strain}));
        EXPECT_NEAR(P(0, 0), E * strain, 1e-5 * E * strain) << name;
        EXPECT_NEAR(P(1, 1), 0, 1e-5 * E * strain) << name;
    }
}

TEST(Law, saint_venant_kirchhoff_softens_and_collapses_under_compression) {
    // Uniaxial strain: P = (lambda/2 + mu) (s^3 - s) falls back to zero at s = 0; its extremum is at 1/sqrt(3).
    const auto [name, material] = make_case("green", Law::saint_venant_kirchhoff);
    const auto stiffness = [&](double stretch) {
        return stress_action(material, Mat3::diagonal({stretch, 1, 1}), Mat3::diagonal({1, 0, 0}))(0, 0);
    };
    EXPECT_GT(stiffness(0.58), 0);
    EXPECT_LT(stiffness(0.57), 0);
    EXPECT_EQ(stress(material, Mat3::diagonal({0, 1, 1}))(0, 0), 0);
}

TEST(Law, everything_is_finite_at_degenerate_gradients) {
    const Mat3 Q = rotation_about(normalized(Vec3{1, 2, 3}), 2.0);
    Draw draw(10);
    for (const auto& [name, material] : all_laws())
        for (const Vec3& d : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{2, 2, 2}, Vec3{1, 1, -1},
                              Vec3{-1, -1, -1}, Vec3{1, -1, 1}, Vec3{2, 1, -1}, Vec3{1, 1 + 1e-15, 1 - 1e-15},
                              Vec3{1, 1e-12, -1e-12}, Vec3{1e-30, 1e-30, 1e-30}, Vec3{1e6, 1, 1e-6}})
            for (const Mat3& F : {Mat3::diagonal(d), Q * Mat3::diagonal(d), Q * Mat3::diagonal(d) * transpose(Q)}) {
                EXPECT_TRUE(std::isfinite(energy(material, F))) << name;
                EXPECT_TRUE(std::isfinite(norm(stress(material, F)))) << name;
                EXPECT_TRUE(std::isfinite(norm(stress_action(material, F, draw.matrix())))) << name;
            }
}

TEST(Law, corotated_and_neo_hookean_push_an_inverted_point_back) {
    for (const auto& [name, material] :
         {make_case("corotated", Law::corotated), make_case("neo_hookean", Law::neo_hookean)}) {
        // Energy falls all the way from the mirror image to rest.
        double last = energy(material, Mat3::diagonal({1, 1, -1}));
        for (double s = -0.95; s < 1; s += 0.05) {
            const double now = energy(material, Mat3::diagonal({1, 1, s}));
            EXPECT_LT(now, last) << name << " at " << s;
            last = now;
        }
    }
}

}  // namespace
}  // namespace phyxel
