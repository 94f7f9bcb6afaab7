#include "contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace phyxel {
namespace {

constexpr int friction_sweeps = 10;        ///< of Gauss-Seidel; a body at rest or sliding needs two or three
constexpr double friction_settled = 1e-3;  ///< largest change of slip in a sweep, against the first, that ends them
constexpr int group_edge = 4;              ///< boxes of the lattice along the edge of a group of samples

/// Order of the samples in which those of one group of boxes follow each other; fills in where the groups begin and
/// end.
template <class Group>
std::vector<std::uint32_t> sort_by_place(const Sampling& s, std::span<const std::uint32_t> cells,
                                         std::vector<Group>& groups) {
    std::vector<std::array<std::int32_t, 3>> key(cells.size());
    for (std::size_t i = 0; i < key.size(); ++i)
        for (int c = 0; c < 3; ++c)
            key[i][c] = static_cast<std::int32_t>(std::floor(double(s.cell_box[cells[i]][c]) / group_edge));
    std::vector<std::uint32_t> order(key.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return key[a] < key[b]; });
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        if (i == 0 || key[order[i]] != key[order[i - 1]]) groups.push_back({i, i, {}});
        groups.back().end = i + 1;
    }
    return order;
}

}  // namespace

ContactSamples::ContactSamples(const Model& model, const ContactSurface& surface, double stable_step,
                               const Threads& threads)
    : has_inside_(surface.has_inside),
      node_inverse_mass_(model.inverse_mass),
      step_squared_(stable_step * stable_step) {
    const Sampling& s = model.sampling;
    const std::vector<std::uint32_t> order = sort_by_place(s, surface.cells, groups_);
    std::vector<Vec3> positions;
    std::vector<std::uint32_t> sorted_cells, sample(order.size());
    for (std::uint32_t v : order) {
        sample[v] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(surface.mesh.vertices[v]);
        sorted_cells.push_back(surface.cells[v]);
    }
    std::vector<Triangle> triangles = surface.mesh.triangles;
    for (Triangle& t : triangles) t = {sample[t[0]], sample[t[1]], sample[t[2]]};
    surface_ = MovingSurface(std::move(triangles), positions.size());
    samples_ = embed(s, model.approximation, positions, sorted_cells, Gradients::no, threads);
    for (Group& group : groups_) {
        const auto begin = samples_.node.begin() + samples_.offset[group.begin],
                   end = samples_.node.begin() + samples_.offset[group.end];
        group.nodes.assign(begin, end);
        std::sort(group.nodes.begin(), group.nodes.end());
        group.nodes.erase(std::unique(group.nodes.begin(), group.nodes.end()), group.nodes.end());
        group.stands_out = stands_out(group, positions, model.rest);
    }
    std::vector<double> covered(model.rest.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const double total = samples_.absolute_sum(i);
        for (std::uint32_t k = samples_.offset[i]; k < samples_.offset[i + 1]; ++k)
            covered[samples_.node[k]] += total * std::abs(samples_.phi[k]);
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        double w = 0, own = 0;
        for (std::uint32_t k = samples_.offset[i]; k < samples_.offset[i + 1]; ++k) {
            const double inverse_mass = model.inverse_mass[samples_.node[k]];
            w = std::max(w, covered[samples_.node[k]] * inverse_mass);
            own += samples_.phi[k] * samples_.phi[k] * inverse_mass;
        }
        inverse_mass_.push_back(w);
        own_inverse_mass_.push_back(own);
    }
}

void ContactSamples::add_to(Hasher& hasher) const {
    hasher.add_value(has_inside_);
    hasher.add_values(std::span<const Triangle>(surface_.triangles()));
    hasher.add_values(std::span<const std::uint32_t>(samples_.node));
    hasher.add_values(std::span<const double>(samples_.phi));
}

double ContactSamples::stands_out(const Group& group, std::span<const Vec3> positions,
                                  std::span<const Vec3> rest) const {
    Bounds box;
    for (std::uint32_t n : group.nodes) box.add(rest[n]);
    double furthest = 0;
    for (std::uint32_t s = group.begin; s < group.end; ++s) {
        Bounds point;
        point.add(positions[s]);
        if (box.overlaps(point)) continue;
        double nearest = std::numeric_limits<double>::infinity();
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k)
            nearest = std::min(nearest, norm(positions[s] - rest[samples_.node[k]]));
        furthest = std::max(furthest, nearest);
    }
    return furthest;
}

Bounds ContactSamples::reach_of(const Group& group, std::span<const Vec3> x) {
    Bounds box;
    for (std::uint32_t n : group.nodes) box.add(x[n]);
    box.grow(std::max(0.2 * norm(box.size()), 1.25 * group.stands_out));
    return box;
}

Bounds ContactSamples::reach(std::span<const Vec3> x) const {
    Bounds all;
    for (const Group& group : groups_) all.add(reach_of(group, x));
    return all;
}

std::vector<ContactSamples::Touch> ContactSamples::touches(std::span<const Collider> colliders, std::span<const Vec3> x,
                                                           const Threads& threads) const {
    std::vector<std::vector<Touch>> found(groups_.size());
    threads.for_each(groups_.size(), 4, [&](std::size_t g) {
        const Bounds box = reach_of(groups_[g], x);
        std::vector<std::uint32_t> near;
        for (std::uint32_t c = 0; c < colliders.size(); ++c)
            if (colliders[c].distance_to_box(box.lower, box.upper) < 0) near.push_back(c);
        if (near.empty()) return;
        for (std::uint32_t s = groups_[g].begin; s < groups_[g].end; ++s) {
            const Vec3 position = samples_.position(s, x);
            for (std::uint32_t c : near) {
                const Distance d = colliders[c].distance(position);
                if (!(d.value < 0)) continue;
                found[g].push_back({s, c, -d.value, stiffness(s) * -d.value, d.normal});
            }
        }
    });
    std::vector<Touch> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::vector<ContactSamples::Touch> ContactSamples::add_forces(std::span<const Collider> colliders,
                                                              std::span<const Vec3> x, const Threads& threads,
                                                              std::span<Vec3> f) const {
    std::vector<Touch> all = touches(colliders, x, threads);
    for (const Touch& touch : all) spread(touch.sample, touch.push * touch.normal, f);
    return all;
}

void ContactSamples::add_friction(std::span<const Collider> colliders, std::span<const Touch> touches, double dt,
                                  std::span<Vec3> v, std::span<Vec3> impulse) const {
    std::vector<Vec3> given(touches.size());
    double first = 0;
    for (int sweep = 0; sweep < friction_sweeps; ++sweep) {
        double largest = 0;
        for (std::size_t t = 0; t < touches.size(); ++t) {
            const Touch& touch = touches[t];
            const double limit = colliders[touch.collider].friction() * touch.push * dt;
            if (limit <= 0) continue;

            // What would stop the slip, as far as the normal force allows.
            const Vec3 velocity = samples_.position(touch.sample, v);
            const Vec3 slip = velocity - dot(velocity, touch.normal) * touch.normal;
            Vec3 wanted = given[t] - slip / own_inverse_mass_[touch.sample];
            const double size = norm(wanted);
            if (size > limit) wanted *= limit / size;
            const Vec3 change = wanted - given[t];
            given[t] = wanted;
            largest = std::max(largest, norm(change) * own_inverse_mass_[touch.sample]);

            for (std::uint32_t k = samples_.offset[touch.sample]; k < samples_.offset[touch.sample + 1]; ++k) {
                const std::uint32_t node = samples_.node[k];
                v[node] += samples_.phi[k] * node_inverse_mass_[node] * change;
                impulse[node] += samples_.phi[k] * change;
            }
        }
        if (sweep == 0) first = largest;
        if (largest <= friction_settled * first) break;
    }
}

double ContactSamples::deepest(std::span<const Collider> colliders, std::span<const Vec3> x,
                               const Threads& threads) const {
    double depth = 0;
    for (const Touch& touch : touches(colliders, x, threads)) depth = std::max(depth, touch.depth);
    return depth;
}

double ContactSamples::energy(std::span<const Collider> colliders, std::span<const Vec3> x,
                              const Threads& threads) const {
    double U = 0;
    for (const Touch& touch : touches(colliders, x, threads)) U += 0.5 * touch.push * touch.depth;
    return U;
}

}  // namespace phyxel
