#include "forces/fast_forces.h"

namespace phyxel {

double FastForces::forces(const Model& m, std::span<const Vec3> x, const Threads& threads, std::span<Vec3> f) {
    const double elastic = cells_.forces(m, x, threads, f);
    return elastic + filter_.add_forces(m, x, threads, f);
}

void FastForces::damped_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                               const Threads& threads, std::span<Vec3> f) {
    cells_.damped_forces(m, x, v, beta, threads, f);
    // The filter's forces are linear.
    ahead_.resize(x.size());
    threads.for_each(x.size(), 1024, [&](std::size_t i) { ahead_[i] = x[i] + beta * v[i]; });
    filter_.add_forces(m, ahead_, threads, f);
}

double FastForces::energy(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    return cells_.energy(m, x, threads) + filter_.energy(m, x, threads);
}

}  // namespace phyxel
