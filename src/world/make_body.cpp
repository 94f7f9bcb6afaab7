#include "world/make_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.h"
#include "geometry/closest_point.h"
#include "geometry/mesh_check.h"
#include "geometry/surface_distance.h"
#include "geometry/thickness.h"
#include "geometry/winding_number.h"
#include "phyxel/error.h"
#include "solver/incremental_potential.h"

namespace phyxel {
namespace {

[[noreturn]] void refuse(const std::string& field, double found, const std::string& expected) {
    throw Error("body " + field + ": found " + format_number(found) + ", expected " + expected);
}

void check_axis(const AxisAngle& rotation, const std::string& field) {
    if (!is_finite(rotation.axis) || norm(rotation.axis) == 0)
        throw Error("body " + field + ".axis: expected a vector of any length but zero");
    if (!std::isfinite(rotation.degrees)) refuse(field + ".degrees", rotation.degrees, "a finite number");
}

void warn_of_thin_parts(const TriangleMesh& mesh, double spacing, World::Parts& parts) {
    const Thickness thickness = local_thickness(mesh);
    if (!(thickness.thinnest < 2 * spacing)) return;
    if (thickness.thinnest >= spacing) {
        parts.warn(
            "a part of the body is thinner than two spacings: its bending stiffness may be off by some per cent");
    } else {
        parts.warn("a part of the body is " + format_number(thickness.thinnest) + " m thin at " +
                   format_point(thickness.place) + ", less than one spacing: a spacing of " +
                   format_number(thickness.thinnest / 2) + " m would resolve it");
    }
}

void warn_of_stencils(const StencilReport& report, World::Parts& parts) {
    if (report.deficient > 0)
        parts.warn("quadrature points whose nodes span no volume (a plate, strand or speck of the body near " +
                       format_point(report.deficient_place) + "); a finer spacing gives it some",
                   report.deficient);
    if (!report.consistent)
        parts.warn("the consistency correction stopped at a patch error of " + format_number(report.consistency_after) +
                   " (from " + format_number(report.consistency_before) +
                   "): stress near the surface is wrong by about that share, and a finer spacing helps");
}

/// The surface that is handed out: the caller's own vertices and triangles, seams included, unless triangles had to be
/// dropped or turned; then the mended mesh.
void make_surface(DynamicBody& body, const TriangleMesh& original, const CheckedMesh& checked, const Threads& threads) {
    const std::vector<Vec3> normals = vertex_normals(checked.mesh);
    if (checked.mesh.triangles.size() != original.triangles.size() || checked.report.flipped_triangles > 0 ||
        checked.report.inside_out) {
        body.surface.emplace(body.model, checked.mesh, normals, threads);
        return;
    }
    std::vector<Vec3> own(original.vertices.size());
    for (std::size_t v = 0; v < own.size(); ++v)
        if (checked.vertex_of[v] != no_index) own[v] = normals[checked.vertex_of[v]];
    body.surface.emplace(body.model, original, own, threads);
}

/// The surface that meets others in place of the body's own.
ContactSurface make_contact_surface(const DynamicBody& body, const TriangleMesh& mesh, const BodySettings& settings,
                                    World::Parts& parts) {
    const std::string field = "body contact_mesh: " + (mesh.source.empty() ? "" : mesh.source + ": ");
    const CheckedMesh checked = check_and_repair(placed(mesh, settings));
    if (checked.mesh.triangles.empty()) throw Error(field + checked.report.refusal);
    try {
        ContactSurface surface = contact_surface(body.model, body.mesh, checked, parts.threads);
        if (surface.has_inside)
            for (const std::string& repair : checked.report.repairs) parts.warn("contact surface: " + repair);
        return surface;
    } catch (const Error& error) {
        throw Error(field + error.what());
    }
}

void warn_of_regions(const Model& model, World::Parts& parts) {
    for (std::size_t r = 1; r < model.mixture.materials.size(); ++r)
        if (!model.mixture.holds(r))
            parts.warn("region " + std::to_string(r - 1) +
                       " holds no part of its body: it lies outside, is thinner than the spacing, or later regions "
                       "cover it. Regions are in rest space, where scale, rotation and translation put the body");
}

void check_region(const Region& region, const std::string& field) {
    if (const auto* box = std::get_if<BoxRegion>(&region.shape)) {
        for (int c = 0; c < 3; ++c)
            if (!(box->lower[c] <= box->upper[c]))
                throw Error("body " + field + ".box: its lower corner is above its upper one; swap them");
    } else if (const auto* sphere = std::get_if<SphereRegion>(&region.shape)) {
        if (!is_finite(sphere->center)) throw Error("body " + field + ".sphere: expected a finite center [m]");
        if (!(sphere->radius > 0) || !std::isfinite(sphere->radius))
            refuse(field + ".sphere radius", sphere->radius, "a finite number above 0 [m]");
    }
    if (!(region.transition >= 0) || !std::isfinite(region.transition))
        refuse(field + ".transition", region.transition, "a finite number of at least 0 [m]");
    try {
        validate(region.material);
    } catch (const Error& error) {
        throw Error("body " + field + ": " + error.what());
    }
}

}  // namespace

std::optional<std::uint32_t> find_cell_of_point(const DynamicBody& body, const Vec3& rest_point) {
    if (!is_finite(rest_point)) return {};
    const TriangleMesh& mesh = body.mesh;
    if (!WindingNumber(mesh).inside(rest_point)) {
        const double reach = 1e-6 * norm(bounding_box(mesh).size());
        if (closest_point(mesh, build_bvh(mesh), rest_point, reach).triangle == no_triangle) return {};
    }
    return body.model.sampling.locate(body.model.sampling.frame.to_lattice(rest_point), {});
}

void validate(const BodySettings& s) {
    if (!(s.scale > 0) || !std::isfinite(s.scale)) refuse("scale", s.scale, "a finite number above 0");
    check_axis(s.rotation, "rotation");
    check_axis(s.lattice_rotation, "sampling.rotation");
    if (!is_finite(s.translation)) throw Error("body translation: expected finite numbers [m]");
    if (!(norm(s.velocity) <= fastest)) refuse("velocity", norm(s.velocity), "at most the speed of light [m/s]");
    if (!is_finite(s.lattice_offset)) throw Error("body sampling.offset: expected finite numbers [spacings]");
    if (!(s.spacing >= 0) || !std::isfinite(s.spacing))
        refuse("spacing", s.spacing, "a finite number above 0 [m], or 0 to use count");
    if (s.spacing == 0 && s.count < 4) refuse("count", static_cast<double>(s.count), "at least 4 nodes");
    const Kernel& k = s.kernel;
    if (k.neighbors == 0 && k.support != 0 && !(k.support >= 1.2 && k.support <= 8))
        refuse("kernel.support", k.support, "1.2 to 8 spacings, or 0 for the default");
    if (k.neighbors != 0 && (k.neighbors < 8 || k.neighbors > 1000))
        refuse("kernel.neighbors", k.neighbors, "8 to 1000, or 0 for none");
    if (k.neighbors != 0 && !(k.dilation >= 1.01 && k.dilation <= 4))
        refuse("kernel.dilation", k.dilation, "1.01 to 4");
    if (!std::isfinite(s.stabilization) || s.stabilization > 10)
        refuse("stabilization", s.stabilization, "0 to 10, or -1 for the default");
    if (!(s.friction >= 0) || !std::isfinite(s.friction))
        refuse("friction", s.friction, "a finite number of at least 0");
    validate(s.material);
    if (s.mean_dilatation == true && s.quadrature == Quadrature::nodes)
        throw Error(
            "body mean_dilatation: belongs to grid quadrature; with points at the nodes a cell has a single one. "
            "Remove it, or use grid quadrature");
    if (s.regions.size() > 65000) refuse("regions", static_cast<double>(s.regions.size()), "at most 65000");
    for (std::size_t r = 0; r < s.regions.size(); ++r) check_region(s.regions[r], "region " + std::to_string(r));
}

TriangleMesh placed(const TriangleMesh& mesh, const BodySettings& settings) {
    TriangleMesh result = mesh;
    const Mat3 R = rotation_matrix(settings.rotation);
    for (Vec3& X : result.vertices) X = R * (settings.scale * X) + settings.translation;
    return result;
}

void find_rest_step(DynamicBody& body, const World::Parts& parts) {
    if (!is_explicit(parts.settings.integrator)) {
        body.rest_step = body.step_limit = parts.settings.time_step;
        return;
    }
    estimate_rest_step(body, parts.around, parts.threads);
    constexpr double most_substeps = 1e7;
    if (body.rest_step * most_substeps > parts.settings.time_step) return;
    throw Error("explicit steps of this body may be no longer than " + format_number(body.rest_step) +
                " s, more than " + format_number(most_substeps) + " for a time step of " +
                format_number(parts.settings.time_step) +
                " s. Lower youngs_modulus or the stiffness damping, or raise density or spacing");
}

void make_contact(DynamicBody& body, const World::Parts& parts) {
    if (body.contact) return;
    body.contact.emplace(body.model, contact_surface(body.model, body.mesh, parts.threads), body.rest_step,
                         parts.threads);
    prepare_contact(body, parts);
}

void prepare_contact(DynamicBody& body, const World::Parts& parts) {
    if (!body.contact) return;
    if (is_explicit(parts.settings.integrator)) {
        body.contact->set_stiffness(ContactSamples::explicit_share, body.rest_step);
        return;
    }
    const double step = body.history.dt > 0 ? body.history.dt : parts.settings.time_step;
    const bool is_static = parts.settings.integrator == Integrator::statics;
    set_contact_stiffness(body, is_static ? std::numeric_limits<double>::infinity() : step);
}

std::unique_ptr<DynamicBody> make_body(const TriangleMesh& mesh, const BodySettings& settings, World::Parts& parts,
                                       MeshReport& mesh_report) {
    validate(settings);
    const TriangleMesh placed_mesh = placed(mesh, settings);
    CheckedMesh checked = check_and_repair(placed_mesh);
    mesh_report = checked.report;
    if (!checked.report.can_be_simulated)
        throw Error((mesh.source.empty() ? "mesh" : mesh.source) + ": cannot be simulated: " + checked.report.refusal);
    for (const std::string& repair : checked.report.repairs) parts.warn(repair);

    const double spacing =
        settings.spacing > 0 ? settings.spacing : spacing_for_count(checked, settings, parts.threads);
    Sampling sampling = sample(checked, settings, spacing, parts.threads);
    warn_of_thin_parts(checked.mesh, spacing, parts);

    auto body = std::make_unique<DynamicBody>();
    StencilReport report;
    body->model = build_model(std::move(sampling), settings, parts.threads, report);
    warn_of_stencils(report, parts);
    warn_of_regions(body->model, parts);
    body->state.x = body->model.rest;
    body->state.v.assign(body->model.rest.size(), settings.velocity);
    make_surface(*body, placed_mesh, checked, parts.threads);
    body->mesh = std::move(checked.mesh);
    body->name = settings.name;
    body->friction = settings.friction;
    find_rest_step(*body, parts);
    if (settings.contact_mesh) {
        // At once, so that what is wrong with it is said here.
        body->separate_contact_surface = true;
        body->contact.emplace(body->model, make_contact_surface(*body, *settings.contact_mesh, settings, parts),
                              body->rest_step, parts.threads);
        prepare_contact(*body, parts);
    }
    return body;
}

}  // namespace phyxel
