#include "scene/frame_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "io/image.h"
#include "io/surface_file.h"

namespace phyxel {
namespace {

std::string numbered(std::size_t frame) { return fmt::format("{:06}", frame); }

std::string vtu_name(const std::string& label, const char* kind, const std::string& number) {
    return fmt::format("frames/{}.{}.{}.vtu", label, kind, number);
}

/// Lists of files are rewritten with each frame as long as that is cheap, then with every hundredth.
bool is_time_to_list(std::size_t frames) { return frames < 1000 || frames % 100 == 0; }

std::span<const double> components(std::span<const Vec3> vectors) {
    return {vectors.empty() ? nullptr : &vectors[0].x, vectors.size() * 3};
}

}  // namespace

std::vector<std::string> file_labels(const std::vector<SceneBody>& bodies) {
    std::vector<std::string> labels;
    for (const SceneBody& body : bodies) {
        std::string label = body.name.substr(0, 80);
        for (char& c : label)
            if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
        while (std::find(labels.begin(), labels.end(), label) != labels.end()) label += '_';
        labels.push_back(std::move(label));
    }
    return labels;
}

FrameFiles::FrameFiles(const Scene& scene, const BuiltScene& built, std::filesystem::path folder,
                       std::size_t first_frame, std::unique_ptr<ScenePainting> painting)
    : scene_(&scene),
      built_(&built),
      folder_(std::move(folder)),
      labels_(file_labels(scene.bodies)),
      painting_(std::move(painting)) {
    const SceneOutput& output = scene.output;
    const std::string from = first_frame == 0 ? "" : ".from-" + numbered(first_frame);

    if (output.writes(OutputFormat::mp4))
        video_ = std::make_unique<Mp4Writer>(folder_ / ("video" + from + ".mp4"), output.width, output.height,
                                             scene.simulation.frame_rate);
    if (output.writes(OutputFormat::glb)) {
        std::vector<GlbMesh> meshes;
        for (std::size_t i = 0; i < built.bodies.size(); ++i)
            meshes.push_back({scene.bodies[i].name, built.world.surface(built.bodies[i]).triangles()});
        animation_ = std::make_unique<GlbWriter>(folder_ / ("animation" + from + ".glb"), meshes);
    }
    const auto is_of_a_frame = [](OutputFormat f) { return f != OutputFormat::mp4 && f != OutputFormat::glb; };
    if (std::any_of(output.formats.begin(), output.formats.end(), is_of_a_frame)) create_folder(folder_ / "frames");
    probes_ = std::make_unique<ProbeLog>(folder_ / "probes.csv", scene, built.world.time());
    if (output.writes(OutputFormat::vtu)) list_earlier_frames(first_frame);
}

void FrameFiles::write(std::size_t frame) {
    const std::string number = numbered(frame);
    for (std::size_t i = 0; i < built_->bodies.size(); ++i) {
        if (scene_->output.writes(OutputFormat::vtu)) write_vtu(number, i);
        write_surface(number, i);
    }
    write_pictures(number);
    if (animation_) {
        std::vector<GlbPose> poses;
        for (const BodyId body : built_->bodies) {
            const Surface& surface = built_->world.surface(body);
            poses.push_back({surface.positions(), surface.normals()});
        }
        animation_->add_frame(built_->world.time(), poses);
    }
    probes_->add_row(*built_);
    if (is_time_to_list(++written_)) write_lists();
}

void FrameFiles::write_vtu(const std::string& number, std::size_t body) {
    const World& world = built_->world;
    const BodyId id = built_->bodies[body];
    const double time = world.time();
    const int part = static_cast<int>(body);

    // Nodes
    const auto X = world.rest_positions(id), x = world.positions(id);
    std::vector<Vec3> displacements(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) displacements[i] = x[i] - X[i];
    const FieldArray node_fields[] = {vector_field("displacement", displacements),
                                      vector_field("velocity", world.velocities(id)),
                                      {"mass", 1, world.masses(id)}};
    nodes_.push_back({time, part, vtu_name(labels_[body], "nodes", number)});
    write_vtu_points(folder_ / nodes_.back().file, x, node_fields);

    // Quadrature points
    const PointFields points = world.point_fields(id);
    const FieldArray point_fields[] = {matrix_field("deformation_gradient", points.deformation_gradient),
                                       matrix_field("cauchy_stress", points.cauchy_stress),
                                       {"von_mises", 1, std::span<const double>(points.von_mises)},
                                       {"principal_stress", 3, components(points.principal_stress)},
                                       {"energy_density", 1, std::span<const double>(points.energy_density)},
                                       {"volume", 1, std::span<const double>(points.volumes)}};
    points_.push_back({time, part, vtu_name(labels_[body], "points", number)});
    write_vtu_points(folder_ / points_.back().file, points.positions, point_fields);

    // Surface
    const Surface& surface = world.surface(id);
    const std::vector<float> von_mises = world.surface_von_mises(id);
    const FieldArray surface_fields[] = {vector_field("normal", surface.normals()),
                                         {"von_mises", 1, std::span<const float>(von_mises)}};
    surfaces_.push_back({time, part, vtu_name(labels_[body], "surface", number)});
    write_vtu_surface(folder_ / surfaces_.back().file, surface.positions(), surface.triangles(), surface_fields);
}

void FrameFiles::write_surface(const std::string& number, std::size_t body) {
    const Surface& surface = built_->world.surface(built_->bodies[body]);
    const SurfaceView view{surface.positions(), surface.triangles(), surface.normals()};
    const std::filesystem::path stem = folder_ / "frames" / (labels_[body] + "." + number);
    if (scene_->output.writes(OutputFormat::ply)) write_ply(stem.string() + ".ply", view);
    if (scene_->output.writes(OutputFormat::obj)) write_obj(stem.string() + ".obj", view);
}

void FrameFiles::write_pictures(const std::string& number) {
    if (!painting_) return;
    const Picture picture = painting_->draw();
    if (scene_->output.writes(OutputFormat::png))
        write_png(folder_ / "frames" / ("picture." + number + ".png"), picture);
    if (video_) video_->add(picture);
}

void FrameFiles::write_lists() const {
    if (!scene_->output.writes(OutputFormat::vtu)) return;
    write_pvd(folder_ / "nodes.pvd", nodes_);
    write_pvd(folder_ / "points.pvd", points_);
    write_pvd(folder_ / "surface.pvd", surfaces_);
}

void FrameFiles::list_earlier_frames(std::size_t first_frame) {
    for (std::size_t frame = 0; frame < first_frame; ++frame)
        for (std::size_t body = 0; body < labels_.size(); ++body) {
            const double time = static_cast<double>(frame) / scene_->simulation.frame_rate;
            const auto list = [&](std::vector<PvdEntry>& entries, const char* kind) {
                const std::string name = vtu_name(labels_[body], kind, numbered(frame));
                std::error_code ignored;
                if (std::filesystem::exists(folder_ / name, ignored))
                    entries.push_back({time, static_cast<int>(body), name});
            };
            list(nodes_, "nodes"), list(points_, "points"), list(surfaces_, "surface");
        }
}

void FrameFiles::finish() {
    write_lists();
    if (video_ && written_ > 0) video_->finish();
    if (animation_ && written_ > 0) animation_->finish();
}

}  // namespace phyxel
