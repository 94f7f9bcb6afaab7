#pragma once

#include <memory>
#include <vector>

#include "model/modelled.h"
#include "solver/integrators.h"
#include "solver/step.h"

/// Bodies in motion and their spectra, for the tests of time stepping.

namespace phyxel {

/// A body at rest with nothing acting on it.
inline std::unique_ptr<DynamicBody> body_of(Model model) {
    auto body = std::make_unique<DynamicBody>();
    body->model = std::move(model);
    body->state.x = body->model.rest;
    body->state.v.assign(body->model.rest.size(), Vec3{});
    return body;
}

/// All angular frequencies of small vibrations [1/s], ascending; rigid motion as 0.
std::vector<double> frequencies(const Model& m);

/// A small vibration: its angular frequency [1/s], and [nodes] where it moves them, of unit mean square over the mass.
struct Mode {
    double omega;
    std::vector<Vec3> shape;
};

/// The lowest one that deforms the body.
Mode lowest_elastic_mode(const Model& m);

/// The largest angular frequency at rest [1/s], by Lanczos iteration in the metric of the masses with full
/// reorthogonalization; `steps` of it.
double largest_frequency(const Model& m, int steps = 100);

inline double total_energy(DynamicBody& body) { return body_energy(body, {}, Threads(1)).total(); }

}  // namespace phyxel
