#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "phyxel/world.h"
#include "solver/dynamic_body.h"

namespace phyxel {

/// Energy that a body stores or moves with [J].
struct BodyEnergy {
    double kinetic = 0, elastic = 0, stabilization = 0, gravitational = 0, contact = 0;
    double constraint = 0;  ///< of penalties
    double stored() const { return elastic + stabilization + contact + constraint; }
    double total() const { return kinetic + stored() + gravitational; }
};

BodyEnergy body_energy(DynamicBody& body, const Surroundings& around, const Threads& threads);

/// Advances all bodies by `duration` [s] from `time`.
///
/// Explicit: in equal substeps no longer than the shortest stable step, which is looked at again every 32 substeps. A
/// result that is not finite, or that gained energy from nowhere, is thrown away and done again with substeps half as
/// long, down to 1/256 of those at rest; then the bodies are left as they were before.
///
/// Implicit: in one step; where that is not found, in 2, 4 ... 64 equal ones. Static: to equilibrium with the loads and
/// grips of `time + duration`.
StepReport advance(std::span<const std::unique_ptr<DynamicBody>> bodies, const Surroundings& around,
                   Integrator integrator, double time, double duration, const Threads& threads);

/// The implicit and static part of `advance`.
StepReport advance_implicitly(std::span<const std::unique_ptr<DynamicBody>> bodies, const Surroundings& around,
                              Integrator integrator, double time, double duration, const Threads& threads);

/// Sets the stable steps of a new body from its rest state.
void estimate_rest_step(DynamicBody& body, const Surroundings& around, const Threads& threads);

}  // namespace phyxel
