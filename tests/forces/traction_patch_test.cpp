#include <gtest/gtest.h>

#include "forces/internal_forces.h"
#include "forces/loaded_box.h"
#include "forces/selection.h"
#include "model/modelled.h"
#include "support/measured.h"
#include "support/two_threads.h"

/// The traction patch test: under a constant stress a body is in equilibrium with the tractions of that stress on its
/// whole surface, at every node. This is what the consistency correction is for.

namespace phyxel {
namespace {

/// f_i = integral of phi_i sigma n over the surface mesh, found by the same clipping as loads.
std::vector<Vec3> traction_forces(const Model& m, const TriangleMesh& mesh, const Mat3& sigma) {
    const SurfaceSelection surface = select_surface(m, mesh, everything);
    const EmbeddedPoints pieces =
        embed(m.sampling, m.approximation, surface.position, surface.cell, Gradients::no, threads);
    std::vector<Vec3> f(m.rest.size());
    for (std::size_t s = 0; s < pieces.size(); ++s) {
        const Vec3 force = sigma * m.sampling.frame.direction_to_rest(surface.area[s]);
        for (std::uint32_t k = pieces.offset[s]; k < pieces.offset[s + 1]; ++k)
            f[pieces.node[k]] += pieces.phi[k] * force;
    }
    return f;
}

/// Largest force that is left at a node of the body under constant strain and the tractions of its stress, over the
/// largest traction force.
double patch_error(const TriangleMesh& mesh, const Model& m) {
    const Mat3 strain = {{{1e-3, 4e-4, -2e-4}, {4e-4, -5e-4, 3e-4}, {-2e-4, 3e-4, 7e-4}}};
    const Mat3 sigma = stress(m.material, Mat3::identity() + strain);
    ForceWorkspace work;
    std::vector<Vec3> f(m.rest.size());
    internal_forces(m, affine(m, Mat3::identity() + strain), {}, 0, work, threads, f);
    const std::vector<Vec3> tractions = traction_forces(m, mesh, sigma);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] += tractions[i];
    return largest(f) / largest(tractions);
}

/// The patch error of every body on both poses of the lattice, aligned first; `check(name, aligned, error)`.
template <class Check>
void for_patch_bodies(const Scheme& scheme, bool corrected, Check&& check) {
    for (const auto& [name, mesh] : patch_bodies())
        for (const bool aligned : {true, false}) {
            BodySettings settings = aligned ? settings_of(scheme) : turned(settings_of(scheme));
            settings.consistency_correction = corrected;
            settings.material.law = Law::linear;
            const CheckedMesh checked = check_and_repair(mesh);
            const Model m = modelled(checked.mesh, settings, equal_spacing(scheme, 0.125));
            check(scheme.name + ", " + name + (aligned ? ", aligned" : ", turned"), aligned,
                  patch_error(checked.mesh, m));
        }
}

class TractionPatch : public testing::TestWithParam<std::size_t> {
protected:
    Scheme scheme() const { return all_schemes()[GetParam()]; }
};

TEST_P(TractionPatch, constant_stress_is_in_equilibrium_with_its_tractions) {
    for_patch_bodies(scheme(), true, [](const std::string& name, bool, double error) {
        EXPECT_LE(error, 1e-10) << name;
        measured(name, error);
    });
}

TEST_P(TractionPatch, fails_without_the_correction) {
    for_patch_bodies(scheme(), false, [](const std::string& name, bool aligned, double error) {
        EXPECT_GT(error, aligned ? 1e-3 : 1e-2) << name;
        measured(name, error);
    });
}

INSTANTIATE_TEST_SUITE_P(Schemes, TractionPatch, testing::Values(0, 1, 2, 3), [](const auto& param) {
    std::string name = all_schemes()[param.param].name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

}  // namespace
}  // namespace phyxel
