#include "solver/integrators.h"

namespace phyxel {

void verlet(DynamicBody& body, const Surroundings& around, double start, double dt, std::size_t count,
            const Threads& threads) {
    evaluate_forces(body, around, start, threads);
    for (std::size_t k = 1; k <= count; ++k) {
        const double time = start + static_cast<double>(k) * dt;
        kick(body, around, dt / 2, dt, time, threads);
        drift(body, dt, threads);
        evaluate_forces(body, around, time, threads);
        kick(body, around, dt / 2, 0, time, threads);
    }
}

}  // namespace phyxel
