#include "forces/constraints.h"

namespace phyxel {

Vec3 Constraints::Row::average(std::span<const Vec3> x) const {
    Vec3 sum{};
    for (std::size_t i = 0; i < node.size(); ++i) sum += coefficient[i] * x[node[i]];
    return sum;
}

Vec3 Constraints::missing(const Row& row, double time, std::span<const Vec3> x) const {
    const HeldFix& fix = fixes_[row.fix];
    const Vec3 target = fix.motion.place(row.rest, time), place = row.average(x);
    Vec3 left{};
    for (std::size_t d = 0; d < 3; ++d)
        if (fix.directions[d]) left[d] = target[d] - place[d];
    return left;
}

std::vector<Vec3> Constraints::free_components(std::size_t nodes) const {
    std::vector<Vec3> free(nodes, Vec3{1, 1, 1});
    for (const Row& row : rows_)
        for (std::size_t d = 0; d < 3; ++d)
            if (row.stiffness == 0 && fixes_[row.fix].directions[d]) free[row.node.front()][d] = 0;
    return free;
}

void Constraints::place_held(double time, std::span<Vec3> x) const {
    for (const Row& row : rows_)
        if (row.stiffness == 0) x[row.node.front()] += missing(row, time, x);
}

double Constraints::penalty_energy(double time, std::span<const Vec3> x) const {
    double U = 0;
    for (const Row& row : rows_)
        if (row.stiffness > 0) U += 0.5 * row.stiffness * norm_squared(missing(row, time, x));
    return U;
}

void Constraints::add_penalty_forces(double time, std::span<const Vec3> x, std::span<Vec3> f) const {
    for (const Row& row : rows_) {
        if (row.stiffness == 0) continue;
        const Vec3 force = row.stiffness * missing(row, time, x);
        for (std::size_t i = 0; i < row.node.size(); ++i) f[row.node[i]] += row.coefficient[i] * force;
    }
}

void Constraints::add_penalty_action(std::span<const Vec3> d, std::span<Vec3> out) const {
    for (const Patch& patch : patches()) {
        Vec3 moved{};
        for (std::size_t i = 0; i < patch.node.size(); ++i) moved += patch.coefficient[i] * d[patch.node[i]];
        const Vec3 force = {patch.stiffness.x * moved.x, patch.stiffness.y * moved.y, patch.stiffness.z * moved.z};
        for (std::size_t i = 0; i < patch.node.size(); ++i) out[patch.node[i]] += patch.coefficient[i] * force;
    }
}

std::vector<Constraints::Patch> Constraints::patches() const {
    std::vector<Patch> list;
    for (const Row& row : rows_) {
        if (row.stiffness == 0) continue;
        Vec3 stiffness{};
        for (std::size_t d = 0; d < 3; ++d) stiffness[d] = fixes_[row.fix].directions[d] ? row.stiffness : 0;
        list.push_back({row.node, row.coefficient, stiffness});
    }
    return list;
}

Constraints::GripWork Constraints::measure(double start, double end, std::span<const Vec3> x,
                                           std::span<const Vec3> sum) {
    GripWork work;
    const double seconds = end - start;
    // A component that several fixes hold is pushed by the first of them.
    std::vector<Vec3> left(sum.begin(), sum.end());
    for (const Row& row : rows_) {
        Vec3 force{};
        const HeldFix& fix = fixes_[row.fix];
        const Vec3 way = fix.motion.place(row.rest, end) - fix.motion.place(row.rest, start);
        if (row.stiffness > 0) {
            force = row.stiffness * missing(row, end, x);
            work.patches += dot(force, way);
        } else {
            for (std::size_t d = 0; d < 3; ++d)
                if (fix.directions[d]) std::swap(force[d], left[row.node.front()][d]);
            force = -force;
            work.nodes += dot(force, way);
        }
        push(row, seconds * force, end);
    }
    return work;
}

}  // namespace phyxel
