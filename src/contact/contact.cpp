#include "contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace phyxel {
namespace {

constexpr int friction_sweeps = 10;        ///< of Gauss-Seidel; a body at rest or sliding needs two or three
constexpr double friction_settled = 1e-3;  ///< largest change of slip in a sweep, against the first, that ends them
constexpr int group_edge = 4;              ///< boxes of the lattice along the edge of a group of samples

struct SamplePlaces {
    std::vector<Vec3> position;  ///< lattice frame
    std::vector<std::uint32_t> cell;
};

SamplePlaces place_samples(const Model& model, const TriangleMesh& mesh) {
    const Sampling& s = model.sampling;
    const double longest = 0.5 * s.pitch;
    TriangleMesh moved = to_lattice(mesh, s.frame), large;
    large.vertices = moved.vertices;

    std::vector<Vec3> outward(moved.vertices.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges_done;
    SamplePlaces places;
    const auto add = [&](const Vec3& position, const Vec3& normal) {
        places.position.push_back(position);
        places.cell.push_back(s.locate(position, normal));
    };
    std::vector<std::pair<Vec3, Vec3>> on_edges;
    for (const Triangle& t : moved.triangles) {
        const Vec3 area =
            cross(moved.vertices[t[1]] - moved.vertices[t[0]], moved.vertices[t[2]] - moved.vertices[t[0]]);
        for (int c = 0; c < 3; ++c) {
            outward[t[c]] += area;
            const std::uint32_t a = std::min(t[c], t[(c + 1) % 3]), b = std::max(t[c], t[(c + 1) % 3]);
            const Vec3 edge = moved.vertices[b] - moved.vertices[a];
            const int parts = static_cast<int>(std::ceil(norm(edge) / longest));
            if (parts < 2 || !edges_done.insert({a, b}).second) continue;
            for (int k = 1; k < parts; ++k) on_edges.emplace_back(moved.vertices[a] + edge * (double(k) / parts), area);
        }
        if (0.5 * norm(area) > 0.5 * longest * longest) large.triangles.push_back(t);
    }
    for (std::size_t v = 0; v < moved.vertices.size(); ++v) add(moved.vertices[v], outward[v]);
    for (const auto& [position, normal] : on_edges) add(position, normal);
    for (const SurfacePoint& piece : cut_surface(large, longest)) add(piece.position, piece.area);
    return places;
}

/// Order of the samples in which those of one group of boxes follow each other; fills in where the groups begin and
/// end.
template <class Group>
std::vector<std::uint32_t> sort_by_place(const Sampling& s, const SamplePlaces& places, std::vector<Group>& groups) {
    std::vector<std::array<std::int32_t, 3>> key(places.cell.size());
    for (std::size_t i = 0; i < key.size(); ++i)
        for (int c = 0; c < 3; ++c)
            key[i][c] = static_cast<std::int32_t>(std::floor(double(s.cell_box[places.cell[i]][c]) / group_edge));
    std::vector<std::uint32_t> order(key.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return key[a] < key[b]; });
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        if (i == 0 || key[order[i]] != key[order[i - 1]]) groups.push_back({i, i, {}});
        groups.back().end = i + 1;
    }
    return order;
}

/// Bounding box of some nodes, widened: shape functions have some negative values, and samples may stick out a little.
std::pair<Vec3, Vec3> reach_of(std::span<const std::uint32_t> nodes, std::span<const Vec3> x) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (std::uint32_t n : nodes)
        for (int c = 0; c < 3; ++c) low[c] = std::min(low[c], x[n][c]), high[c] = std::max(high[c], x[n][c]);
    const double margin = 0.2 * norm(high - low);
    return {low - Vec3{margin, margin, margin}, high + Vec3{margin, margin, margin}};
}

}  // namespace

ContactSamples::ContactSamples(const Model& model, const TriangleMesh& mesh, double stable_step, const Threads& threads)
    : node_inverse_mass_(model.inverse_mass), step_squared_(stable_step * stable_step) {
    const SamplePlaces places = place_samples(model, mesh);
    const std::vector<std::uint32_t> order = sort_by_place(model.sampling, places, groups_);
    std::vector<Vec3> positions;
    std::vector<std::uint32_t> cells;
    for (std::uint32_t s : order) positions.push_back(places.position[s]), cells.push_back(places.cell[s]);
    samples_ = embed(model.sampling, model.approximation, positions, cells, Gradients::no, threads);
    for (Group& group : groups_) {
        const auto begin = samples_.node.begin() + samples_.offset[group.begin],
                   end = samples_.node.begin() + samples_.offset[group.end];
        group.nodes.assign(begin, end);
        std::sort(group.nodes.begin(), group.nodes.end());
        group.nodes.erase(std::unique(group.nodes.begin(), group.nodes.end()), group.nodes.end());
    }
    std::vector<double> covered(model.rest.size());
    for (std::size_t s = 0; s < samples_.size(); ++s) {
        double total = 0;
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k) total += std::abs(samples_.phi[k]);
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k)
            covered[samples_.node[k]] += total * std::abs(samples_.phi[k]);
    }
    for (std::size_t s = 0; s < samples_.size(); ++s) {
        double w = 0, own = 0;
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k) {
            const double inverse_mass = model.inverse_mass[samples_.node[k]];
            w = std::max(w, covered[samples_.node[k]] * inverse_mass);
            own += samples_.phi[k] * samples_.phi[k] * inverse_mass;
        }
        inverse_mass_.push_back(w);
        own_inverse_mass_.push_back(own);
    }
}

std::vector<ContactSamples::Touch> ContactSamples::touches(std::span<const Collider> colliders, std::span<const Vec3> x,
                                                           const Threads& threads) const {
    std::vector<std::vector<Touch>> found(groups_.size());
    threads.for_each(groups_.size(), 4, [&](std::size_t g) {
        const auto [low, high] = reach_of(groups_[g].nodes, x);
        std::vector<std::uint32_t> near;
        for (std::uint32_t c = 0; c < colliders.size(); ++c)
            if (colliders[c].distance_to_box(low, high) < 0) near.push_back(c);
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
