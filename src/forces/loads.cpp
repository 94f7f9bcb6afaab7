#include "forces/loads.h"

namespace phyxel {

SurfaceLoad::SurfaceLoad(const Model& model, const TriangleMesh& mesh, const Load& load, const Threads& threads)
    : ramp_(load.ramp), pressure_(load.pressure) {
    const SurfaceSelection selection = select_surface(model, mesh, load.box);
    const Gradients gradients = pressure_ ? Gradients::yes : Gradients::no;
    pieces_ = embed(model.sampling, model.approximation, selection.position, selection.cell, gradients, threads);
    if (pressure_) {
        for (const Vec3& area : selection.area) area_.push_back(model.sampling.frame.direction_to_rest(area));
        return;
    }
    const Vec3 traction = load.traction ? *load.traction : *load.force / selection.total_area;
    std::vector<Vec3> force(model.rest.size());
    for (std::size_t s = 0; s < pieces_.size(); ++s)
        for (std::uint32_t k = pieces_.offset[s]; k < pieces_.offset[s + 1]; ++k)
            force[pieces_.node[k]] += pieces_.phi[k] * norm(selection.area[s]) * traction;
    *this = SurfaceLoad(force);
    ramp_ = load.ramp;
}

SurfaceLoad::SurfaceLoad(std::span<const Vec3> forces) {
    for (std::uint32_t i = 0; i < forces.size(); ++i)
        if (forces[i] != Vec3{}) node_.push_back(i), force_.push_back(forces[i]);
}

void SurfaceLoad::add(double time, std::span<const Vec3> x, std::span<Vec3> f) const {
    const double part = share(time);
    for (std::size_t k = 0; k < node_.size(); ++k) f[node_[k]] += part * force_[k];
    for (std::size_t s = 0; s < area_.size(); ++s) {
        const Vec3 force = (-part * *pressure_) * (cofactor(pieces_.deformation_gradient(s, x)) * area_[s]);
        for (std::uint32_t k = pieces_.offset[s]; k < pieces_.offset[s + 1]; ++k)
            f[pieces_.node[k]] += pieces_.phi[k] * force;
    }
}

void SurfaceLoad::add_to(Hasher& hasher) const {
    hasher.add_value(ramp_);
    hasher.add_value(pressure_.value_or(0));
    hasher.add_values(std::span<const std::uint32_t>(node_));
    hasher.add_values(std::span<const Vec3>(force_));
    hasher.add_values(std::span<const std::uint32_t>(pieces_.node));
    hasher.add_values(std::span<const Vec3>(area_));
}

}  // namespace phyxel
