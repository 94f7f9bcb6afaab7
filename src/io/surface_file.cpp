#include "io/surface_file.h"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <cstdint>
#include <iterator>

#include "base/atomic_file.h"
#include "io/finite_values.h"

namespace phyxel {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

void check(const std::filesystem::path& path, const SurfaceView& surface) {
    assert(surface.normals.empty() || surface.normals.size() == surface.positions.size());
    require_finite(path, "positions", surface.positions);
    require_finite(path, "normals", surface.normals);
    for (const VertexScalar& scalar : surface.scalars) {
        assert(scalar.values.size() == surface.positions.size());
        require_finite(path, scalar.name, scalar.values);
    }
}

std::string ply_header(const SurfaceView& surface) {
    std::string header =
        fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", surface.positions.size());
    for (const char* axis : {"x", "y", "z"}) header += fmt::format("property float {}\n", axis);
    if (!surface.normals.empty())
        for (const char* axis : {"nx", "ny", "nz"}) header += fmt::format("property float {}\n", axis);
    for (const VertexScalar& scalar : surface.scalars) header += fmt::format("property float {}\n", scalar.name);
    header +=
        fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", surface.triangles.size());
    return header;
}

}  // namespace

void write_ply(const std::filesystem::path& path, const SurfaceView& surface) {
    check(path, surface);
    AtomicFile file(path);
    file.write(ply_header(surface));
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        file.write_value(surface.positions[v]);
        if (!surface.normals.empty()) file.write_value(surface.normals[v]);
        for (const VertexScalar& scalar : surface.scalars) file.write_value(scalar.values[v]);
    }
    for (const Triangle& triangle : surface.triangles) {
        file.write_value(std::uint8_t(3));
        file.write_value(triangle);
    }
    file.commit();
}

void write_obj(const std::filesystem::path& path, const SurfaceView& surface) {
    check(path, surface);
    AtomicFile file(path);
    fmt::memory_buffer line;
    const auto put = [&](auto format, const auto&... values) {
        line.clear();
        fmt::format_to(std::back_inserter(line), format, values...);
        file.write(std::string_view(line.data(), line.size()));
    };
    for (const Vec3f& p : surface.positions) put(FMT_STRING("v {} {} {}\n"), p.x, p.y, p.z);
    for (const Vec3f& n : surface.normals) put(FMT_STRING("vn {} {} {}\n"), n.x, n.y, n.z);
    for (const auto& [a, b, c] : surface.triangles) {
        if (surface.normals.empty()) put(FMT_STRING("f {} {} {}\n"), a + 1, b + 1, c + 1);
        else put(FMT_STRING("f {0}//{0} {1}//{1} {2}//{2}\n"), a + 1, b + 1, c + 1);
    }
    file.commit();
}

}  // namespace phyxel
