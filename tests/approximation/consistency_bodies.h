#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "approximation/consistency.h"
#include "approximation/moving_least_squares.h"
#include "approximation/support_search.h"
#include "geometry/clipping.h"
#include "geometry/clipping_shapes.h"

/// Bodies on a lattice with one quadrature point per clipped octant, made the plain way.

namespace phyxel {

struct LatticeBody {
    static constexpr double support_in_spacings = 2.2;

    std::vector<Vec3> nodes;
    std::vector<Vec3> points;
    std::vector<double> volumes, support;
    std::vector<std::uint32_t> offset{0}, node;
    std::vector<Vec3> gradient;  // [pairs]
    std::vector<Vec3> surface;   // [nodes] b_i = closed-surface integral of phi_i n

    /// Forces of a unit isotropic stress, b_i - sum_q V_q g_qi.
    std::vector<Vec3> residual() const {
        std::vector<Vec3> r = surface;
        for (std::size_t q = 0; q < points.size(); ++q)
            for (std::size_t pair = offset[q]; pair < offset[q + 1]; ++pair)
                r[node[pair]] -= volumes[q] * gradient[pair];
        return r;
    }

    /// Largest |b_i - sum V g| over the largest |b_i|.
    double patch_error() const {
        double error = 0, scale = 0;
        for (const Vec3& r : residual()) error = std::max(error, norm(r));
        for (const Vec3& b : surface) scale = std::max(scale, norm(b));
        return error / scale;
    }

    ConsistencyReport correct(int threads = 2) {
        const std::vector<Vec3> r = residual();
        return make_consistent({nodes, points, volumes, support, offset, node, r, KernelShape::quartic_spline},
                               gradient, Threads(threads));
    }
};

/// The body of `mesh` on a lattice whose planes pass through the origin; the octant (i, j, k) belongs to the node
/// nearest to it.
inline LatticeBody lattice_body(const TriangleMesh& mesh, double spacing) {
    const ClippedVolume clipped = clip_closed(mesh, spacing / 2, Threads(2));
    using Site = std::array<int, 3>;
    LatticeBody body;
    std::map<Site, std::uint32_t> site_node;
    for (const Octant& octant : clipped.octants) {
        const Site site = {(octant.index[0] + 1) >> 1, (octant.index[1] + 1) >> 1, (octant.index[2] + 1) >> 1};
        if (!site_node.emplace(site, static_cast<std::uint32_t>(body.nodes.size())).second) continue;
        body.nodes.push_back(spacing * Vec3{double(site[0]), double(site[1]), double(site[2])});
    }

    std::vector<std::uint32_t> found;
    std::vector<Vec3> offsets;
    ShapeFunctions shape;
    const auto approximate = [&](const Vec3& X, double radius) {
        found.clear(), offsets.clear();
        const auto low = [&](double x) { return static_cast<int>(std::ceil((x - radius) / spacing)); };
        const auto high = [&](double x) { return static_cast<int>(std::floor((x + radius) / spacing)); };
        for (int i = low(X.x); i <= high(X.x); ++i)
            for (int j = low(X.y); j <= high(X.y); ++j)
                for (int k = low(X.z); k <= high(X.z); ++k)
                    if (const auto it = site_node.find({i, j, k}); it != site_node.end())
                        if (const Vec3 e = body.nodes[it->second] - X; norm(e) < radius)
                            found.push_back(it->second), offsets.push_back(e);
        MovingLeastSquares(KernelShape::quartic_spline, radius).values_and_gradients(offsets, shape);
    };
    const auto widened = [&](const Vec3& X) {
        double radius = LatticeBody::support_in_spacings * spacing;
        const auto sound = [&] {
            return found.size() >= 8 &&
                   varies_more_than(1e-2 * spacing * spacing, offsets, KernelShape::quartic_spline, radius);
        };
        for (approximate(X, radius); !sound(); approximate(X, radius)) radius *= 1.12;
        return radius;
    };

    for (const Octant& octant : clipped.octants) {
        body.support.push_back(widened(octant.centroid));
        body.points.push_back(octant.centroid);
        body.volumes.push_back(octant.volume);
        body.node.insert(body.node.end(), found.begin(), found.end());
        body.gradient.insert(body.gradient.end(), shape.gradient.begin(), shape.gradient.end());
        body.offset.push_back(static_cast<std::uint32_t>(body.node.size()));
    }
    body.surface.assign(body.nodes.size(), Vec3{});
    for (const SurfacePoint& piece : clipped.boundary) {
        widened(piece.position);
        for (std::size_t i = 0; i < found.size(); ++i) body.surface[found[i]] += shape.phi[i] * piece.area;
    }
    return body;
}

/// Both bodies as one, without a point that sees nodes of both.
inline LatticeBody side_by_side(LatticeBody a, const LatticeBody& b) {
    const auto nodes = static_cast<std::uint32_t>(a.nodes.size()), pairs = static_cast<std::uint32_t>(a.node.size());
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(a.nodes, b.nodes), append(a.points, b.points), append(a.volumes, b.volumes), append(a.support, b.support);
    append(a.gradient, b.gradient), append(a.surface, b.surface);
    for (const std::uint32_t i : b.node) a.node.push_back(nodes + i);
    for (std::size_t q = 1; q < b.offset.size(); ++q) a.offset.push_back(pairs + b.offset[q]);
    return a;
}

}  // namespace phyxel
