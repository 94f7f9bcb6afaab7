#include "forces/fast_forces.h"

namespace phyxel {

double FastForces::forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) {
    const double elastic = cells_.forces(m, x, threads, f);
    return elastic + filter_.add_forces(m, x, threads, f);
}

double FastForces::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    return cells_.energy(m, x, threads) + filter_.energy(m, x, threads);
}

}  // namespace phyxel
