#pragma once

#include <optional>
#include <span>

#include "base/hash.h"
#include "forces/selection.h"

namespace phyxel {

/// A load on a body, as nodal forces (Brunet et al. 2019, eq. 17): f_i = sum_s phi_si t_s A_s over the pieces of the
/// loaded surface. Momentum is exact, because sum phi = 1 and x_s = sum phi x.
class SurfaceLoad {
public:
    SurfaceLoad(const Model& model, const TriangleMesh& mesh, const Load& load, const Threads& threads);
    /// A dead load that varies from place to place, given as its nodal forces [nodes] [N].
    explicit SurfaceLoad(std::span<const Vec3> forces);

    /// Adds the forces at time `time` [s] to `f`. Pressure follows the surface: -p cof(F) N dA.
    void add(double time, std::span<const Vec3> x, std::span<Vec3> f) const;

    /// Adds all that the load is to a hash.
    void add_to(Hasher& hasher) const;

private:
    double share(double time) const { return ramp_ <= 0 || time >= ramp_ ? 1 : time / ramp_; }

    double ramp_ = 0;
    std::vector<std::uint32_t> node_;  ///< [loaded nodes] dead loads: nodes and their full forces
    std::vector<Vec3> force_;          ///< [loaded nodes] [N]
    std::optional<double> pressure_;   ///< [Pa]
    EmbeddedPoints pieces_;            ///< pressure only
    std::vector<Vec3> area_;           ///< [pieces] rest normal times area, rest space [m^2]
};

}  // namespace phyxel
