#include "model/mixture.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh_check.h"
#include "geometry/surface_distance.h"
#include "phyxel/error.h"

namespace phyxel {
namespace {

/// What a point stands for: a cube of the lattice.
struct Surrounding {
    Vec3 center;  ///< lattice frame
    double width;
};

Surrounding surrounding(const Sampling& s, std::size_t q) {
    if (s.quadrature == Quadrature::nodes && s.lattice == Lattice::bcc) return {s.points[q], s.pitch * std::cbrt(4.0)};
    if (s.quadrature == Quadrature::nodes || s.lattice == Lattice::bcc)
        return {s.cell_centers[s.point_cell[q]], s.pitch};
    const double octant = s.pitch / 2;
    Vec3 center;
    for (int c = 0; c < 3; ++c) center[c] = octant * (std::floor(s.points[q][c] / octant) + 0.5);
    return {center, octant};
}

/// Share of a cube of that width (along the axes of rest space) around X that a shape fills.
double filled(const BoxRegion& box, const Vec3& X, double width) {
    double share = 1;
    for (int c = 0; c < 3; ++c) {
        const double overlap = std::min(box.upper[c], X[c] + width / 2) - std::max(box.lower[c], X[c] - width / 2);
        share *= std::clamp(overlap / width, 0.0, 1.0);
    }
    return share;
}
double filled(const SphereRegion& sphere, const Vec3& X, double width) {
    return std::clamp(0.5 - (norm(X - sphere.center) - sphere.radius) / width, 0.0, 1.0);
}
double filled(const SurfaceDistance& surface, const Vec3& X, double width) {
    return std::clamp(0.5 - surface(X, width) / width, 0.0, 1.0);
}

/// Shares that rounding left of octants whose faces lie on the region's boundary are none.
double without_slivers(double share) { return share < 1e-6 ? 0 : share > 1 - 1e-6 ? 1 : share; }

std::vector<double> shares_of(const Region& region, const Sampling& s, const Threads& threads) {
    std::vector<double> share(s.points.size());
    const auto fill = [&](const auto& shape) {
        threads.for_each(share.size(), 256, [&](std::size_t q) {
            const Surrounding around = surrounding(s, q);
            const double width = std::max(around.width, region.transition);
            share[q] = without_slivers(filled(shape, s.frame.to_rest(around.center), width));
        });
    };
    if (const auto* box = std::get_if<BoxRegion>(&region.shape)) fill(*box);
    else if (const auto* sphere = std::get_if<SphereRegion>(&region.shape)) fill(*sphere);
    else {
        const CheckedMesh checked = check_and_repair(std::get<TriangleMesh>(region.shape));
        if (!checked.report.can_be_simulated)
            throw Error((checked.mesh.source.empty() ? "mesh of a region" : checked.mesh.source) +
                        ": has no inside that a region could be: " + checked.report.refusal);
        fill(SurfaceDistance(checked.mesh));
    }
    return share;
}

/// What a point is made of while regions are laid over it, one after the other.
struct Layers {
    std::vector<std::uint16_t> material;
    std::vector<double> share;

    void cover(std::uint16_t region, double part) {
        if (part == 1) material.clear(), share.clear();
        for (double& s : share) s *= 1 - part;
        material.push_back(region);
        share.push_back(part);
    }
    void keep_largest() {
        const auto largest = std::max_element(share.begin(), share.end()) - share.begin();
        material = {material[static_cast<std::size_t>(largest)]};
        share = {1};
    }
};

}  // namespace

bool Mixture::holds(std::size_t index) const {
    return std::find(material.begin(), material.end(), index) != material.end();
}

std::uint16_t Mixture::main_material(std::size_t q) const {
    const auto begin = share.begin() + offset[q], end = share.begin() + offset[q + 1];
    return material[offset[q] + static_cast<std::size_t>(std::max_element(begin, end) - begin)];
}

double Mixture::mean(std::size_t q, double Material::*number) const {
    double sum = 0;
    for (std::uint32_t k = offset[q]; k < offset[q + 1]; ++k) sum += share[k] * materials[material[k]].*number;
    return sum;
}

MaterialPoint Mixture::point(std::size_t q) const {
    MaterialPoint point{.law = materials[main_material(q)].law, .lame = {}, .volume_stiffness = 0};
    for (std::uint32_t k = offset[q]; k < offset[q + 1]; ++k) {
        const MaterialPoint part = material_point(materials[material[k]]);
        point.lame.lambda += share[k] * part.lame.lambda;
        point.lame.mu += share[k] * part.lame.mu;
        point.volume_stiffness += share[k] * part.volume_stiffness;
    }
    return point;
}

Mixture mix(const Sampling& s, const BodySettings& settings, const Threads& threads) {
    if (settings.regions.empty()) return {};
    Mixture mixture;
    mixture.materials.push_back(settings.material);
    std::vector<std::vector<double>> shares;
    for (const Region& region : settings.regions) {
        mixture.materials.push_back(region.material);
        shares.push_back(shares_of(region, s, threads));
    }

    mixture.offset.push_back(0);
    for (std::size_t q = 0; q < s.points.size(); ++q) {
        Layers layers{{0}, {1}};
        bool smooth = false;
        for (std::size_t r = 0; r < shares.size(); ++r) {
            if (shares[r][q] == 0) continue;
            layers.cover(static_cast<std::uint16_t>(r + 1), shares[r][q]);
            smooth = shares[r][q] < 1 && settings.regions[r].transition > 0;
            const auto law = [&](std::uint16_t m) { return mixture.materials[m].law; };
            if (std::all_of(layers.material.begin(), layers.material.end(),
                            [&](std::uint16_t m) { return law(m) == law(layers.material[0]); }))
                continue;
            if (smooth)
                throw Error("region " + std::to_string(r) +
                            ": its transition would blend two laws; give both materials the same law, or leave out "
                            "the transition");
            layers.keep_largest();
        }
        mixture.material.insert(mixture.material.end(), layers.material.begin(), layers.material.end());
        mixture.share.insert(mixture.share.end(), layers.share.begin(), layers.share.end());
        mixture.offset.push_back(static_cast<std::uint32_t>(mixture.material.size()));
    }
    return mixture;
}

}  // namespace phyxel
