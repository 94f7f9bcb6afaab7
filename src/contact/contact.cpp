#include "contact/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace phyxel {
namespace {

constexpr double stiffness_share = 0.5;  ///< beta; the explicit bound is 4, less what elasticity takes
constexpr double friction_share = 0.5;   ///< largest share of the slip that one step may take away
constexpr double slip_scale = 1e-3;      ///< eps_v [m/s]
constexpr std::size_t sample_chunk = 256;

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

}  // namespace

ContactSamples::ContactSamples(const Model& model, const TriangleMesh& mesh, double stable_step, const Threads& threads)
    : step_squared_(stable_step * stable_step) {
    const SamplePlaces places = place_samples(model, mesh);
    samples_ = embed(model.sampling, model.approximation, places.position, places.cell, Gradients::no, threads);
    std::vector<double> covered(model.rest.size());
    for (std::size_t s = 0; s < samples_.size(); ++s) {
        double total = 0;
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k) total += std::abs(samples_.phi[k]);
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k)
            covered[samples_.node[k]] += total * std::abs(samples_.phi[k]);
    }
    for (std::size_t s = 0; s < samples_.size(); ++s) {
        double w = 0;
        for (std::uint32_t k = samples_.offset[s]; k < samples_.offset[s + 1]; ++k)
            w = std::max(w, covered[samples_.node[k]] * model.inverse_mass[samples_.node[k]]);
        inverse_mass_.push_back(w);
    }
}

std::vector<ContactSamples::Touch> ContactSamples::touches(std::span<const Collider> colliders, std::span<const Vec3> x,
                                                           const Threads& threads) const {
    // Obstacles that the body's bounding box does not come near are out.
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (const Vec3& p : x)
        for (int c = 0; c < 3; ++c) low[c] = std::min(low[c], p[c]), high[c] = std::max(high[c], p[c]);
    // Samples are affine combinations of nodes with some negative weights: they may stick out of the box a little.
    const double margin = 0.1 * norm(high - low);
    std::vector<std::uint32_t> near;
    for (std::uint32_t c = 0; c < colliders.size(); ++c)
        if (colliders[c].distance_to_box(low, high) < margin) near.push_back(c);
    if (near.empty()) return {};

    std::vector<std::vector<Touch>> found((samples_.size() + sample_chunk - 1) / sample_chunk);
    threads.for_chunks(samples_.size(), sample_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            const Vec3 position = samples_.position(s, x);
            for (std::uint32_t c : near) {
                const Distance d = colliders[c].distance(position);
                if (d.value < 0)
                    found[begin / sample_chunk].push_back({static_cast<std::uint32_t>(s), c, -d.value, d.normal});
            }
        }
    });
    std::vector<Touch> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::size_t ContactSamples::add_forces(std::span<const Collider> colliders, std::span<const Vec3> x,
                                       std::span<const Vec3> v, double dt, const Threads& threads, std::span<Vec3> f,
                                       std::span<Vec3> friction) const {
    const std::vector<Touch> all = touches(colliders, x, threads);
    for (const Touch& touch : all) {
        const std::uint32_t begin = samples_.offset[touch.sample], end = samples_.offset[touch.sample + 1];
        const double w = inverse_mass_[touch.sample];
        const double push = stiffness_share / (step_squared_ * w) * touch.depth;
        const Vec3 velocity = samples_.position(touch.sample, v);
        const Vec3 slip = velocity - dot(velocity, touch.normal) * touch.normal;
        const double drag = std::min(colliders[touch.collider].friction() * push / std::max(norm(slip), slip_scale),
                                     friction_share / (dt * w));
        for (std::uint32_t k = begin; k < end; ++k) {
            f[samples_.node[k]] += samples_.phi[k] * (push * touch.normal - drag * slip);
            friction[samples_.node[k]] -= samples_.phi[k] * drag * slip;
        }
    }
    return all.size();
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
    for (const Touch& touch : touches(colliders, x, threads))
        U += 0.5 * stiffness_share / (step_squared_ * inverse_mass_[touch.sample]) * touch.depth * touch.depth;
    return U;
}

}  // namespace phyxel
