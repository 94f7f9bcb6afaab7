#include "io/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "io/finite_values.h"
#include "io/glb_container.h"
#include "phyxel/error.h"
#include "phyxel/version.h"

namespace phyxel {
namespace {

using OrderedJson = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF is little endian; numbers are written as they lie");

// Names that glTF takes from OpenGL.
constexpr int gl_unsigned_int = 5125, gl_float = 5126, gl_array_buffer = 34962, gl_element_array_buffer = 34963;

/// Room left for the index below the 4 GiB that the container's lengths allow: about 600 bytes a body and frame, so
/// enough for any animation whose data fits.
constexpr std::uint64_t largest_file = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t index_size_of_target = 600;

OrderedJson as_json(const Vec3f& v) { return OrderedJson::array({v.x, v.y, v.z}); }

std::array<Vec3f, 2> extents_of(std::span<const Vec3f> points) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    std::array<Vec3f, 2> box = {Vec3f{infinity, infinity, infinity}, Vec3f{-infinity, -infinity, -infinity}};
    for (const Vec3f& p : points)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box[0][axis] = std::min(box[0][axis], p[axis]);
            box[1][axis] = std::max(box[1][axis], p[axis]);
        }
    return box;
}

/// Builds the lists of views (stretches of the data) and accessors (typed arrays in a view); what is added last lies
/// last in the data.
class ArrayIndex {
public:
    /// Opens a view of `size` bytes behind the last one.
    void add_view(std::uint64_t size, OrderedJson properties) {
        OrderedJson view = {{"buffer", 0}, {"byteOffset", end_}, {"byteLength", size}};
        view.update(properties);
        views_.push_back(std::move(view));
        end_ += size;
        offset_ = 0;
    }

    /// An array in the last view, behind the one before; gives its number.
    std::size_t add_array(int component_type, const char* type, std::size_t count, std::size_t value_size,
                          OrderedJson properties = OrderedJson::object()) {
        OrderedJson accessor = {{"bufferView", views_.size() - 1},
                                {"byteOffset", offset_},
                                {"componentType", component_type},
                                {"count", count},
                                {"type", type}};
        accessor.update(properties);
        accessors_.push_back(std::move(accessor));
        offset_ += count * value_size;
        return accessors_.size() - 1;
    }

    void move_into(OrderedJson& root) {
        root["accessors"] = std::move(accessors_);
        root["bufferViews"] = std::move(views_);
        root["buffers"] = OrderedJson::array({{{"byteLength", end_}}});
    }

private:
    OrderedJson views_ = OrderedJson::array(), accessors_ = OrderedJson::array();
    std::uint64_t end_ = 0, offset_ = 0;
};

}  // namespace

GlbWriter::GlbWriter(std::filesystem::path path, std::span<const GlbMesh> meshes) : path_(std::move(path)) {
    for (const GlbMesh& mesh : meshes)
        bodies_.push_back({mesh.name, mesh.color, {mesh.triangles.begin(), mesh.triangles.end()}, 0, {}});
}

void GlbWriter::add_frame(double time, std::span<const GlbPose> poses) {
    assert(poses.size() == bodies_.size());
    require_finite(path_, "times", std::span<const double>(&time, 1));
    if (!times_.empty() && static_cast<float>(time) <= times_.back()) return;
    // Nothing is added before all is known to be right.
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        Body& body = bodies_[b];
        if (times_.empty()) body.vertices = poses[b].positions.size();
        if (poses[b].positions.size() != body.vertices)
            throw Error(
                fmt::format("cannot write {}: the surface of \"{}\" changed from {} to {} vertices at {} s, and a "
                            "GLB animation cannot follow that; choose the format \"ply\" or \"vtu\"",
                            path_.string(), body.name, body.vertices, poses[b].positions.size(), time));
        assert(poses[b].normals.size() == body.vertices);
        require_finite(path_, "positions", poses[b].positions);
        require_finite(path_, "normals", poses[b].normals);
    }
    if (size_bound(times_.size() + 1) > largest_file)
        throw Error(
            fmt::format("cannot write {}: with {} frames it would exceed the 4 GiB that a GLB file can hold; "
                        "lower the frame rate or the duration, or choose the format \"ply\" or \"vtu\"",
                        path_.string(), times_.size() + 1));
    for (std::size_t b = 0; b < bodies_.size(); ++b) add_pose(bodies_[b], poses[b]);
    times_.push_back(static_cast<float>(time));
}

/// The first pose as it is, later ones as differences to it.
void GlbWriter::add_pose(Body& body, const GlbPose& pose) {
    std::vector<Vec3f> vectors(pose.positions.begin(), pose.positions.end());
    vectors.insert(vectors.end(), pose.normals.begin(), pose.normals.end());
    if (!body.shapes.empty()) {
        const std::vector<Vec3f>& base = body.shapes.front().vectors;
        for (std::size_t i = 0; i < base.size(); ++i) vectors[i] -= base[i];
    }
    const std::array<Vec3f, 2> extents = extents_of(std::span(vectors).first(body.vertices));
    body.shapes.push_back({std::move(vectors), extents});
}

/// [frames][targets]: frame k > 0 shows target k - 1 and no other, the first frame shows none.
std::vector<float> GlbWriter::weights() const {
    const std::size_t frames = times_.size(), targets = frames - 1;
    std::vector<float> result(frames * targets);
    for (std::size_t frame = 1; frame < frames; ++frame) result[frame * targets + frame - 1] = 1;
    return result;
}

/// An upper bound of the file's size with so many frames [bytes].
std::uint64_t GlbWriter::size_bound(std::size_t frames) const {
    std::uint64_t size = 4 * frames * (frames + 1) + 4096;
    for (const Body& body : bodies_)
        size += sizeof(Triangle) * body.triangles.size() +
                frames * (2 * sizeof(Vec3f) * body.vertices + index_size_of_target);
    return size;
}

/// The JSON part: nodes, meshes with their targets, the animation, and where the arrays lie.
std::string GlbWriter::index(std::size_t weights) const {
    OrderedJson root = {{"asset", {{"version", "2.0"}, {"generator", fmt::format("phyxel {}", version)}}},
                        {"scene", 0},
                        {"scenes", OrderedJson::array({{{"nodes", OrderedJson::array()}}})}};
    ArrayIndex arrays;

    // Bodies: indices, then positions and normals of every frame, in turn.
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const Body& body = bodies_[b];
        arrays.add_view(sizeof(Triangle) * body.triangles.size(), {{"target", gl_element_array_buffer}});
        const std::size_t indices =
            arrays.add_array(gl_unsigned_int, "SCALAR", 3 * body.triangles.size(), sizeof(std::uint32_t));
        arrays.add_view(2 * sizeof(Vec3f) * body.vertices * body.shapes.size(),
                        {{"byteStride", sizeof(Vec3f)}, {"target", gl_array_buffer}});
        OrderedJson attributes = OrderedJson::array();
        for (const Shape& shape : body.shapes) {
            const std::size_t positions =
                arrays.add_array(gl_float, "VEC3", body.vertices, sizeof(Vec3f),
                                 {{"min", as_json(shape.extents[0])}, {"max", as_json(shape.extents[1])}});
            const std::size_t normals = arrays.add_array(gl_float, "VEC3", body.vertices, sizeof(Vec3f));
            attributes.push_back({{"POSITION", positions}, {"NORMAL", normals}});
        }
        OrderedJson primitive = {{"attributes", attributes[0]}, {"indices", indices}, {"material", b}};
        attributes.erase(0);
        OrderedJson mesh = {{"name", body.name}, {"primitives", OrderedJson::array()}};
        if (!attributes.empty()) {
            mesh["weights"] = std::vector<int>(attributes.size(), 0);
            primitive["targets"] = std::move(attributes);
        }
        mesh["primitives"].push_back(std::move(primitive));
        root["meshes"].push_back(std::move(mesh));
        root["nodes"].push_back({{"name", body.name}, {"mesh", b}});
        root["scenes"][0]["nodes"].push_back(b);
        root["materials"].push_back({{"name", body.name},
                                     {"doubleSided", true},
                                     {"pbrMetallicRoughness",
                                      {{"baseColorFactor", {body.color.x, body.color.y, body.color.z, 1.0f}},
                                       {"metallicFactor", 0},
                                       {"roughnessFactor", 0.6}}}});
    }

    // The animation: the same times and weights drive the targets of every body.
    if (weights > 0) {
        arrays.add_view(sizeof(float) * times_.size(), OrderedJson::object());
        const std::size_t input = arrays.add_array(
            gl_float, "SCALAR", times_.size(), sizeof(float),
            {{"min", OrderedJson::array({times_.front()})}, {"max", OrderedJson::array({times_.back()})}});
        arrays.add_view(sizeof(float) * weights, OrderedJson::object());
        const std::size_t output = arrays.add_array(gl_float, "SCALAR", weights, sizeof(float));
        OrderedJson channels = OrderedJson::array();
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            channels.push_back({{"sampler", 0}, {"target", {{"node", b}, {"path", "weights"}}}});
        root["animations"].push_back(
            {{"name", "simulation"},
             {"samplers", OrderedJson::array({{{"input", input}, {"interpolation", "LINEAR"}, {"output", output}}})},
             {"channels", std::move(channels)}});
    }
    arrays.move_into(root);
    std::string text = root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return text;
}

void GlbWriter::finish() const {
    assert(!times_.empty());
    const std::vector<float> weights = this->weights();
    const std::string text = index(weights.size());

    // All arrays are of 4-byte numbers, so that nothing needs padding.
    std::uint64_t data = 0;
    for (const Body& body : bodies_)
        data += sizeof(Triangle) * body.triangles.size() + 2 * sizeof(Vec3f) * body.vertices * body.shapes.size();
    if (!weights.empty()) data += std::span(times_).size_bytes() + std::span(weights).size_bytes();
    const std::uint64_t size = 12 + 8 + text.size() + 8 + data;

    AtomicFile file(path_);
    file.write_value(std::array{glb::magic, glb::version, static_cast<std::uint32_t>(size)});
    file.write_value(std::array{static_cast<std::uint32_t>(text.size()), glb::json_chunk});
    file.write(text);
    file.write_value(std::array{static_cast<std::uint32_t>(data), glb::binary_chunk});
    for (const Body& body : bodies_) {
        file.write_values(std::span<const Triangle>(body.triangles));
        for (const Shape& shape : body.shapes) file.write_values(std::span(shape.vectors));
    }
    if (!weights.empty()) {
        file.write_values(std::span<const float>(times_));
        file.write_values(std::span<const float>(weights));
    }
    file.commit();
}

}  // namespace phyxel
