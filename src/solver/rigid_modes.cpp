#include "solver/rigid_modes.h"

#include <algorithm>
#include <cmath>

namespace phyxel {

RigidModes::Mode RigidModes::make_mode(const Body& body, std::size_t kind) {
    Vec3 center{};
    double mass = 0, moment = 0;
    for (std::size_t i = 0; i < body.x.size(); ++i) mass += body.mass[i], center += body.mass[i] * body.x[i];
    center *= 1 / mass;
    for (std::size_t i = 0; i < body.x.size(); ++i) moment += body.mass[i] * norm_squared(body.x[i] - center);
    const double radius = std::sqrt(moment / mass);
    Vec3 axis{};
    axis[kind % 3] = 1;
    Mode mode{body.first, {}, {}};
    for (const Vec3& x : body.x) mode.way.push_back(kind < 3 ? axis : cross(axis, x - center) / radius);
    return mode;
}

void RigidModes::add_resistance(const Body& body, std::span<const Vec3> contact, Mode& mode) {
    for (std::size_t n = 0; n < contact.size(); ++n) {
        Vec3 force = contact[n];
        if (n >= body.first && n < body.first + body.x.size())
            force += body.inertia * body.mass[n - body.first] * mode.way[n - body.first];
        if (!(force == Vec3{})) mode.resistance.push_back({static_cast<std::uint32_t>(n), force});
    }
}

void RigidModes::factorize() {
    const auto size = static_cast<Eigen::Index>(modes_.size());
    Eigen::MatrixXd E(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index j = 0; j < size; ++j) {
            const Mode &a = modes_[static_cast<std::size_t>(i)], &b = modes_[static_cast<std::size_t>(j)];
            double sum = 0;
            for (const Entry& e : b.resistance)
                if (e.node >= a.first && e.node < a.first + a.way.size()) sum += dot(a.way[e.node - a.first], e.force);
            E(i, j) = sum;
        }
    if (!E.allFinite()) return clear();
    factor_.compute(0.5 * (E + E.transpose()));
    if (factor_.info() != Eigen::Success) clear();
}

Eigen::VectorXd RigidModes::take(std::vector<Vec3>& r) const {
    Eigen::VectorXd share(static_cast<Eigen::Index>(modes_.size()));
    for (std::size_t m = 0; m < modes_.size(); ++m) {
        double sum = 0;
        for (std::size_t i = 0; i < modes_[m].way.size(); ++i) sum += dot(modes_[m].way[i], r[modes_[m].first + i]);
        share[static_cast<Eigen::Index>(m)] = sum;
    }
    const Eigen::VectorXd taken = factor_.solve(share);
    for (std::size_t m = 0; m < modes_.size(); ++m)
        for (const Entry& e : modes_[m].resistance) r[e.node] -= taken[static_cast<Eigen::Index>(m)] * e.force;
    return taken;
}

void RigidModes::add(const Eigen::VectorXd& taken, std::vector<Vec3>& z) const {
    Eigen::VectorXd share(static_cast<Eigen::Index>(modes_.size()));
    for (std::size_t m = 0; m < modes_.size(); ++m) {
        double sum = 0;
        for (const Entry& e : modes_[m].resistance) sum += dot(e.force, z[e.node]);
        share[static_cast<Eigen::Index>(m)] = sum;
    }
    const Eigen::VectorXd motion = taken - factor_.solve(share);
    for (std::size_t m = 0; m < modes_.size(); ++m)
        for (std::size_t i = 0; i < modes_[m].way.size(); ++i)
            z[modes_[m].first + i] += motion[static_cast<Eigen::Index>(m)] * modes_[m].way[i];
}

}  // namespace phyxel
