#include "solver/coupled_bodies.h"

#include <algorithm>
#include <cmath>

#include "solver/nodal_vectors.h"

namespace phyxel {

CoupledBodies::CoupledBodies(std::vector<Part> parts, const BodyContact* contact, const Threads& t)
    : threads(t), parts_(std::move(parts)), offset_{0}, contact_(contact) {
    for (const Part& part : parts_) offset_.push_back(offset_.back() + part.potential->size());
}

void CoupledBodies::gradient(const std::vector<Vec3>& x, std::vector<Vec3>& g) {
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].potential->gradient(of(p, x), of(p, g));
    if (!contact_ || contact_->empty()) return;
    std::vector<Vec3> force(x.size());
    contact_->add_forces(x, force);
    contact_->add_friction_forces(x, force);
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].potential->add_free(-1, of(p, force), of(p, g));
}

void CoupledBodies::action(const std::vector<Vec3>& x, const std::vector<Vec3>& d, std::vector<Vec3>& out) {
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].potential->action(of(p, x), of(p, d), of(p, out));
    if (!contact_ || contact_->empty()) return;
    std::vector<Vec3> force(x.size());
    contact_->add_action(x, d, force);
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].potential->add_free(1, of(p, force), of(p, out));
}

void CoupledBodies::place_held(std::vector<Vec3>& x) const {
    for (std::size_t p = 0; p < parts_.size(); ++p)
        parts_[p].potential->body.constraints.place_held(parts_[p].potential->time, of(p, x));
}

void CoupledBodies::turn(const std::vector<Vec3>& x) {
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].preconditioner->turn(of(p, x), threads);
}

bool CoupledBodies::support(const std::vector<Vec3>& x) {
    bool any = false;
    std::vector<Mat3> between;
    if (contact_ && !contact_->empty()) {
        between.resize(x.size());
        contact_->add_lumped(x, between);
    }
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        std::vector<Mat3> blocks = parts_[p].potential->supports(of(p, x));
        if (!between.empty()) {
            blocks.resize(parts_[p].potential->size());
            for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] += between[offset_[p] + i];
        }
        any = any || !blocks.empty();
        parts_[p].preconditioner->set_supports(std::move(blocks), threads);
    }
    find_rigid_modes(x);
    return any;
}

void CoupledBodies::find_rigid_modes(const std::vector<Vec3>& x) {
    modes_.clear();
    std::vector<RigidModes::Body> free;
    bool touch = contact_ && !contact_->empty();
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        const IncrementalPotential& potential = *parts_[p].potential;
        if (!potential.body.constraints.empty() || potential.inertia == 0) continue;
        free.push_back({offset_[p], of(p, x), potential.body.model.mass, potential.inertia});
        touch = touch || !potential.body.touches.empty();
    }
    if (!touch || free.empty()) return;
    modes_.build(free, x.size(), [&](const std::vector<Vec3>& d, std::vector<Vec3>& out) {
        for (std::size_t p = 0; p < parts_.size(); ++p)
            parts_[p].potential->add_contact_action(of(p, x), of(p, d), of(p, out));
        if (contact_) contact_->add_action(x, d, out);
    });
}

double CoupledBodies::distance(const std::vector<Vec3>& g, const std::vector<Vec3>& z) const {
    double furthest = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        const std::span<const Vec3> own_g = of(p, g), own_z = of(p, z);
        const double product =
            threads.sum(own_g.size(), node_chunk, [&](std::size_t i) { return dot(own_g[i], own_z[i]); });
        // With contact between them only the sum over all bodies is sure to be positive.
        const double own = std::sqrt(parts_.size() > 1 ? std::abs(product) : product) / parts_[p].way;
        if (!(own <= furthest)) furthest = own;
        if (!std::isfinite(furthest)) return furthest;
    }
    return furthest;
}

void CoupledBodies::precondition(const std::vector<Vec3>& r, std::vector<Vec3>& z) {
    if (modes_.empty()) return precondition_alone(r, z);
    std::vector<Vec3> rest = r;
    const Eigen::VectorXd taken = modes_.take(rest);
    precondition_alone(rest, z);
    modes_.add(taken, z);
}

void CoupledBodies::precondition_alone(const std::vector<Vec3>& r, std::vector<Vec3>& z) {
    if (parts_.size() == 1) return parts_.front().preconditioner->apply(r, z, threads);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        const std::span<const Vec3> own = of(p, r);
        std::vector<Vec3> residual(own.begin(), own.end()), result(own.size());
        parts_[p].preconditioner->apply(residual, result, threads);
        std::copy(result.begin(), result.end(), of(p, z).begin());
    }
}

}  // namespace phyxel
