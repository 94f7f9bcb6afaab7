#include "forces/internal_forces.h"

#include <gtest/gtest.h>

#include "forces/derivatives.h"
#include "model/all_laws.h"
#include "model/modelled.h"
#include "support/measured.h"

namespace phyxel {
namespace {

/// All schemes with and without stabilization and correction: a box of 70 to 120 nodes that no lattice plane fits.
std::vector<NamedModel> all_discretizations() {
    std::vector<NamedModel> cases;
    for (const Scheme& scheme : all_schemes())
        for (const double stabilization : {-1.0, 0.0})
            for (const bool correction : {true, false}) {
                BodySettings settings = turned(settings_of(scheme));
                settings.stabilization = stabilization;
                settings.consistency_correction = correction;
                cases.push_back(
                    {scheme.name + (stabilization == 0 ? "" : ", stabilized") + (correction ? ", corrected" : ""),
                     modelled(make_box({1, 0.8, 0.6}), settings, equal_spacing(scheme, 0.28))});
            }
    return cases;
}

/// Calls `check(name, model)` for every discretization with every law.
template <class Check>
void for_all_bodies(Check&& check) {
    for (auto& [name, model] : all_discretizations())
        for (const auto& [law, material] : all_laws()) {
            set_material(model, material);
            check(name + ", " + law, model);
        }
}

TEST(InternalForces, are_the_negative_gradient_of_the_energy) {
    double worst = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const double error = force_error(m, turned_stretched_and_shaken(m));
        EXPECT_LE(error, 1e-7) << name;
        worst = std::max(worst, error);
    });
    measured("force against differences", worst);
}

TEST(InternalForces, change_by_the_stiffness_action) {
    double worst = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const double error = stiffness_error(m, turned_stretched_and_shaken(m));
        EXPECT_LE(error, 1e-7) << name;
        worst = std::max(worst, error);
    });
    measured("stiffness against differences", worst);
}

TEST(InternalForces, stiffness_action_is_symmetric) {
    for_all_bodies([&](const std::string& name, const Model& m) {
        const auto x = turned_stretched_and_shaken(m);
        const auto a = random_field(x.size(), 1, 5), b = random_field(x.size(), 1, 6);
        const auto Ka = stiffness_times(m, x, a), Kb = stiffness_times(m, x, b);
        EXPECT_LE(std::abs(inner(b, Ka) - inner(a, Kb)), 1e-13 * std::sqrt(inner(b, b) * inner(Ka, Ka))) << name;
    });
}

TEST(InternalForces, net_force_and_torque_vanish) {
    double worst_force = 0, worst_torque = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const auto x = turned_stretched_and_shaken(m), f = forces(m, x);
        EXPECT_LE(net_force(f), 1e-13) << name;
        worst_force = std::max(worst_force, net_force(f));
        if (m.settings.law == Law::linear) return;  // small strain knows no rotation
        EXPECT_LE(net_torque(x, f), 1e-13) << name;
        worst_torque = std::max(worst_torque, net_torque(x, f));
    });
    measured("net force", worst_force);
    measured("net torque", worst_torque);
}

TEST(InternalForces, linear_law_pulls_on_a_turned_body_and_no_other_does) {
    double worst = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const auto x = affine(m, some_rotation(), {5, 6, 7});
        const double E = m.settings.youngs_modulus, a = m.node_length;
        const double stored = total_energy(m, x) / (E * m.sampling.clipped_volume),
                     pull = largest(forces(m, x)) / (E * a * a);
        if (m.settings.law == Law::linear) {
            EXPECT_GT(stored, 0.1) << name;
            EXPECT_GT(pull, 0.1) << name;
            return;
        }
        EXPECT_LE(stored, 1e-16) << name;
        EXPECT_LE(pull, 1e-12) << name;
        worst = std::max(worst, pull);
    });
    measured("force under rotation over E a^2", worst);
}

TEST(InternalForces, affine_motion_is_met_exactly) {
    const Mat3 F = some_rotation() * some_stretch();
    double worst = 0, worst_energy = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const auto x = affine(m, F, {5, 6, 7});
        double error = 0;
        for (const Mat3& found : deformation_gradients(m, x, threads)) error = std::max(error, norm(found - F));
        EXPECT_LE(error, 1e-12) << name;
        const double exact = m.sampling.clipped_volume * energy(m.material, F);
        EXPECT_LE(std::abs(total_energy(m, x) - exact), 1e-12 * exact) << name;
        worst = std::max(worst, error);
        worst_energy = std::max(worst_energy, std::abs(total_energy(m, x) / exact - 1));
    });
    measured("deformation gradient", worst);
    measured("energy", worst_energy);
}

TEST(InternalForces, are_the_same_for_any_number_of_threads) {
    for (const auto& [name, m] : all_discretizations()) {
        const auto x = turned_stretched_and_shaken(m), v = random_field(x.size(), 1, 8), f = forces(m, x, v, 1e-3);
        for (const int count : {1, 3, 8}) {
            ForceWorkspace work;
            std::vector<Vec3> other(x.size());
            internal_forces(m, x, v, 1e-3, work, Threads(count), other);
            EXPECT_TRUE(f == other) << name << ", " << count << " threads";
        }
    }
}

/// Viscous part of the forces.
std::vector<Vec3> viscous_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta) {
    const auto with = forces(m, x, v, beta), without = forces(m, x);
    std::vector<Vec3> f;
    for (std::size_t i = 0; i < x.size(); ++i) f.push_back(with[i] - without[i]);
    return f;
}

TEST(InternalForces, stiffness_damping_is_beta_times_the_stiffness_at_rest) {
    constexpr double beta = 1;
    for_all_bodies([&](const std::string& name, const Model& m) {
        if (m.settings.volume_stiffness > 0) return;  // the volume force is not damped
        const auto v = random_field(m.rest.size(), 1, 9), f = viscous_forces(m, m.rest, v, beta);
        std::vector<Vec3> expected = stiffness_times(m, m.rest, v);
        for (Vec3& e : expected) e *= -beta;
        EXPECT_LE(largest_difference(f, expected), 1e-12 * largest(f)) << name;
    });
}

TEST(InternalForces, stiffness_damping_takes_power_without_net_force_or_torque) {
    constexpr double beta = 1;
    double worst = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        const auto x = turned_stretched_and_shaken(m);
        for (unsigned seed = 1; seed <= 4; ++seed) {
            const auto v = random_field(x.size(), 1, seed), f = viscous_forces(m, x, v, beta);
            ForceWorkspace work;
            std::vector<Vec3> total(x.size());
            const double power = internal_forces(m, x, v, beta, work, threads, total);
            EXPECT_GT(power, 0) << name;
            EXPECT_LE(std::abs(power + inner(f, v)), 1e-11 * power) << name;
            EXPECT_LE(net_force(f), 1e-13) << name;
            // The damping of the stabilization goes by its Hessian, which knows no rotation beyond affine states.
            EXPECT_LE(net_torque(x, f), m.stabilization > 0 ? 5e-3 : 1e-13) << name;
            worst = std::max(worst, net_torque(x, f));
        }
    });
    measured("torque of stiffness damping, stabilized", worst);
}

TEST(InternalForces, stiffness_damping_leaves_rigid_motion_alone) {
    constexpr double beta = 1;
    const Vec3 spin = {1, -2, 3};
    double worst = 0;
    for_all_bodies([&](const std::string& name, const Model& m) {
        for (const bool is_affine : {true, false}) {
            const auto x = is_affine ? affine(m, some_rotation() * some_stretch()) : turned_stretched_and_shaken(m);
            std::vector<Vec3> v;
            for (const Vec3& p : x) v.push_back(cross(spin, p) + Vec3{4, 5, 6});
            const double scale = largest(viscous_forces(m, x, random_field(x.size(), norm(spin), 1), beta));
            const double error = largest(viscous_forces(m, x, v, beta)) / scale;
            EXPECT_LE(error, is_affine || m.stabilization == 0 ? 1e-12 : 1e-2) << name;
            worst = std::max(worst, error);
        }
    });
    measured("damping of rotation, shaken and stabilized", worst);
}

}  // namespace
}  // namespace phyxel
