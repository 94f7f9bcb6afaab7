#include "contact/body_contact.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace phyxel {
namespace {

constexpr double reach_outside = 0.5;  ///< [spacings] from which a sample may come to touch within a step
constexpr double reach_inside = 0.75;  ///< [spacings] how deep contact may hold one, besides how far the step goes

std::vector<Vec3> sample_places(const BodyContact::Side& side, std::span<const Vec3> x, const Threads& threads) {
    const EmbeddedPoints& samples = side.surface->samples();
    std::vector<Vec3> places(samples.size());
    threads.for_each(places.size(), 256, [&](std::size_t s) { places[s] = samples.position(s, x); });
    return places;
}

bool comes_before(const BodyStick& a, const BodyStick& b) {
    return std::tie(a.sample, a.other) < std::tie(b.sample, b.other);
}

}  // namespace

void BodyContact::find(const std::vector<Vec3>& x, const std::vector<Vec3>& start, double motion,
                       const Threads& threads) {
    pairs_.clear();
    entries_.clear();
    const auto own = [&](const Side& side) { return std::span(x).subspan(side.first, side.nodes); };
    std::vector<std::vector<Vec3>> places;
    for (const Side& side : sides_) places.push_back(sample_places(side, own(side), threads));
    for (std::uint32_t s = 0; s < sides_.size(); ++s)
        for (std::uint32_t o = 0; o < sides_.size(); ++o) {
            if (s == o || !sides_[o].surface->has_inside()) continue;
            const std::span<const std::uint32_t> apart = sides_[s].apart;
            if (!std::binary_search(apart.begin(), apart.end(), sides_[o].number))
                find_between(s, o, motion, places, x, threads);
        }
    set_stiffness();
    set_friction(x, start);
}

void BodyContact::find_between(std::uint32_t s, std::uint32_t o, double motion,
                               const std::vector<std::vector<Vec3>>& places, const std::vector<Vec3>& x,
                               const Threads& threads) {
    const Side &side = sides_[s], &other = sides_[o];
    const std::span<const Vec3> own_x = std::span(x).subspan(side.first, side.nodes);
    const double outside = reach_outside * std::min(side.spacing, other.spacing);
    const double inside = reach_inside * other.spacing + motion;
    Bounds other_box;
    for (const Vec3& place : places[o]) other_box.add(place);
    other_box.grow(outside);
    std::vector<std::uint32_t> near;
    side.surface->visit_near(other_box, own_x, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            Bounds point;
            point.add(places[s][i]);
            if (point.overlaps(other_box)) near.push_back(i);
        }
    });
    if (near.empty()) return;

    // The triangles of the other surface that may be their nearest.
    Bounds near_box;
    for (std::uint32_t i : near) near_box.add(places[s][i]);
    near_box.grow(inside);
    TriangleMesh target;
    target.vertices = places[o];
    std::vector<std::uint32_t> name;
    const std::vector<Triangle>& triangles = other.surface->surface().triangles();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        Bounds box;
        for (std::uint32_t v : triangles[t]) box.add(places[o][v]);
        if (box.overlaps(near_box)) target.triangles.push_back(triangles[t]), name.push_back(t);
    }
    const Bvh tree = build_bvh(target);

    struct Found {
        SurfaceFoot foot{no_triangle, {}, 0};
        Vec3 normal{};
    };
    std::vector<Found> found(near.size());
    threads.for_each(near.size(), 16, [&](std::size_t k) {
        const Vec3& place = places[s][near[k]];
        SurfaceFoot foot = closest_point(target, tree, place, inside);
        if (foot.triangle == no_triangle) return;
        foot.triangle = name[foot.triangle];
        const Vec3 outward = other.surface->surface().outward(places[o], foot), way = place - foot.point.position;
        if (outward == Vec3{}) return;  // all its triangles are flat
        const bool within = dot(way, outward) < 0;
        if (!within && foot.distance > outside) return;
        // At the surface itself the way there has no direction.
        const bool clear = foot.distance > 1e-9 * other.spacing;
        found[k] = {foot, clear ? (within ? -1 : 1) / foot.distance * way : outward};
    });

    // Pairs, and which nodes carry them.
    const EmbeddedPoints &own = side.surface->samples(), &others = other.surface->samples();
    for (std::size_t k = 0; k < near.size(); ++k) {
        if (found[k].foot.triangle == no_triangle) continue;
        Pair pair{s, o, near[k], static_cast<std::uint32_t>(entries_.size()), 0, {found[k].normal}};
        for (std::uint32_t e = own.offset[near[k]]; e < own.offset[near[k] + 1]; ++e)
            entries_.push_back({static_cast<std::uint32_t>(side.first + own.node[e]), own.phi[e]});
        std::vector<Entry> ground;
        for (std::size_t c = 0; c < 3; ++c) {
            const double share = found[k].foot.point.weights[c];
            if (share == 0) continue;
            const std::uint32_t v = triangles[found[k].foot.triangle][c];
            for (std::uint32_t e = others.offset[v]; e < others.offset[v + 1]; ++e)
                ground.push_back({static_cast<std::uint32_t>(other.first + others.node[e]), -share * others.phi[e]});
        }
        std::stable_sort(ground.begin(), ground.end(), [](const Entry& a, const Entry& b) { return a.node < b.node; });
        for (std::size_t e = 0; e < ground.size(); ++e) {
            if (e > 0 && ground[e].node == ground[e - 1].node) entries_.back().weight += ground[e].weight;
            else entries_.push_back(ground[e]);
        }
        pair.end = static_cast<std::uint32_t>(entries_.size());
        pairs_.push_back(pair);
    }
}

void BodyContact::set_stiffness() {
    // What all pairs together ask of a node of the ground, as the samples' own stiffness has it for theirs.
    const auto is_ground = [&](const Pair& pair, const Entry& e) {
        const Side& other = sides_[pair.other];
        return e.node >= other.first && e.node < other.first + other.nodes;
    };
    std::vector<double> covered(sides_.back().first + sides_.back().nodes);
    for (const Pair& pair : pairs_)
        for (std::uint32_t k = pair.begin; k < pair.end; ++k)
            if (is_ground(pair, entries_[k])) covered[entries_[k].node] += std::abs(entries_[k].weight);
    for (Pair& pair : pairs_) {
        const Side& other = sides_[pair.other];
        double w = 0;
        for (std::uint32_t k = pair.begin; k < pair.end; ++k)
            if (is_ground(pair, entries_[k]))
                w = std::max(
                    w, covered[entries_[k].node] * other.surface->node_inverse_mass(entries_[k].node - other.first));
        const double own = sides_[pair.side].surface->stiffness(pair.sample),
                     ground = other.surface->stiffness_against(w);
        pair.spring.stiffness = own * ground / (own + ground);
    }
}

void BodyContact::set_friction(const std::vector<Vec3>& x, const std::vector<Vec3>& start) {
    for (Pair& pair : pairs_) {
        const Side &side = sides_[pair.side], &other = sides_[pair.other];
        pair.spring.limit = std::sqrt(side.friction * other.friction) * pair.spring.stiffness *
                            std::max(0.0, -dot(pair.spring.normal, apart(pair, x)));
        pair.origin = apart(pair, start);
        const BodyStick wanted{pair.sample, other.number, {}};
        const auto old = std::lower_bound(side.sticks.begin(), side.sticks.end(), wanted, comes_before);
        if (old != side.sticks.end() && !comes_before(wanted, *old)) pair.origin -= old->stretch;
    }
}

void BodyContact::add_forces(const std::vector<Vec3>& x, std::vector<Vec3>& f) const {
    for (const Pair& pair : pairs_) {
        const double d = dot(pair.spring.normal, apart(pair, x));
        if (d < 0) spread(pair, -pair.spring.stiffness * d * pair.spring.normal, f);
    }
}

void BodyContact::add_friction_forces(const std::vector<Vec3>& x, std::vector<Vec3>& f) const {
    for (const Pair& pair : pairs_)
        if (pair.spring.limit > 0) spread(pair, pair.spring.force(slip(pair, x)), f);
}

void BodyContact::add_action(const std::vector<Vec3>& x, const std::vector<Vec3>& d, std::vector<Vec3>& out) const {
    for (const Pair& pair : pairs_) {
        const Vec3 change = apart(pair, d), across = pair.spring.slip(change);
        Vec3 force{};
        if (dot(pair.spring.normal, apart(pair, x)) < 0) force += pair.spring.stiffness * (change - across);
        if (pair.spring.limit > 0) force += pair.spring.action(slip(pair, x), across);
        spread(pair, force, out);
    }
}

void BodyContact::add_lumped(const std::vector<Vec3>& x, std::vector<Mat3>& blocks) const {
    for (const Pair& pair : pairs_) {
        Mat3 K;
        if (dot(pair.spring.normal, apart(pair, x)) < 0)
            K += pair.spring.stiffness * outer(pair.spring.normal, pair.spring.normal);
        if (pair.spring.limit > 0) K += pair.spring.held_stiffness(slip(pair, x));
        double sum = 0;  // w w^T <= (sum |w|) diag(|w|)
        for (std::uint32_t k = pair.begin; k < pair.end; ++k) sum += std::abs(entries_[k].weight);
        for (std::uint32_t k = pair.begin; k < pair.end; ++k)
            blocks[entries_[k].node] += sum * std::abs(entries_[k].weight) * K;
    }
}

double BodyContact::energy(std::size_t side, const std::vector<Vec3>& x) const {
    double U = 0;
    for (const Pair& pair : pairs_) {
        if (pair.side != side) continue;
        const double d = std::min(0.0, dot(pair.spring.normal, apart(pair, x)));
        U += 0.5 * pair.spring.stiffness * d * d;
    }
    return U;
}

std::vector<BodyStick> BodyContact::sticks(std::size_t side, const std::vector<Vec3>& x) const {
    std::vector<BodyStick> list;
    for (const Pair& pair : pairs_) {
        if (pair.side != side || pair.spring.limit == 0) continue;
        list.push_back({pair.sample, sides_[pair.other].number, pair.spring.kept(slip(pair, x))});
    }
    std::sort(list.begin(), list.end(), comes_before);
    return list;
}

std::size_t BodyContact::touching(std::size_t side, const std::vector<Vec3>& x) const {
    std::size_t count = 0;
    for (const Pair& pair : pairs_) count += pair.side == side && dot(pair.spring.normal, apart(pair, x)) < 0;
    return count;
}

double BodyContact::deepest(const std::vector<Vec3>& x) const {
    double depth = 0;
    for (const Pair& pair : pairs_) depth = std::max(depth, -dot(pair.spring.normal, apart(pair, x)));
    return depth;
}

}  // namespace phyxel
