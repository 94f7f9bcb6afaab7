#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "phyxel/world.h"
#include "reference/fem/solve.h"

/// The beam of Brunet et al. 2019, section 4.1: 20 x 20 x 200 mm along z, clamped at z = 0, with a dead force on its
/// other end, E = 50 N/mm^2, nu = 0.45. (12 and 1500 N/mm^2, as printed, are total forces in newtons.)

namespace phyxel::studies {

inline constexpr Vec3 beam_size = {0.02, 0.02, 0.2};
inline constexpr Vec3 bending = {0, -12, 0}, stretching = {0, 0, 1500};  // on its end [N]
inline constexpr Material beam_material = {
    .density = 1000, .youngs_modulus = 50e6, .poissons_ratio = 0.45, .law = Law::corotated};

/// Displacements of the centre of the end face [mm] to which triquadratic hexahedra converge, extrapolated, to the last
/// digit but one; CalculiX agrees to 0.09 % in bending and 0.01 % in stretching.
inline constexpr double bent_tip = -45.162, stretched_tip = 14.8789;

/// Spacings of the cubic lattices of 189, 496, 1025, 1836 and 2989 nodes [m]: `n` cells across.
inline double beam_spacing(std::size_t n) { return 0.02 / double(n); }
inline std::size_t beam_nodes(std::size_t n) { return (n + 1) * (n + 1) * (10 * n + 1); }

/// A beam in equilibrium.
struct BeamResult {
    std::size_t nodes = 0;
    Vec3 tip;  ///< displacement of the centre of the end face [mm]
    std::size_t iterations = 0;
    double seconds = 0;  ///< processor time of the solve, its preparation included
    bool converged = false;
    std::uint64_t hash = 0;   ///< of the state; meshless only
    std::vector<Vec3> field;  ///< displacements at 3 x 3 x 11 points [mm], the same for every size; meshless only
};

/// Settings of that beam on a cubic lattice of `n` cells across.
BodySettings beam_settings(std::size_t n, const Material& material = beam_material);
/// `change` is called once the beam is made, before it is solved.
BeamResult meshless_beam(const BodySettings& settings, const Vec3& force, int threads,
                         const std::function<void(World&, BodyId)>& change = {});

/// The same beam of n x n x 10 n boxes.
BeamResult element_beam(fem::ElementType type, std::size_t n, const Vec3& force,
                        const Material& material = beam_material, fem::Split split = fem::Split::six);

/// Deflection along the force, relative to a reference [mm], minus one.
double tip_error(const BeamResult& beam, const Vec3& force, double reference);
inline double tip_error(const BeamResult& beam, const Vec3& force) {
    return tip_error(beam, force, force.z > 0 ? stretched_tip : bent_tip);
}

}  // namespace phyxel::studies
