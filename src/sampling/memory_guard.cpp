#include "sampling/memory_guard.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "base/format.h"
#include "phyxel/error.h"

namespace phyxel {
namespace {

constexpr double bytes_per_node = 14e3;   ///< measured: 9 to 12 kB a node in double, while being set up a little more
constexpr double bytes_per_octant = 120;  ///< of the bounding box, while clipping

/// Memory that can still be had [bytes].
double available_bytes() {
    std::ifstream info("/proc/meminfo");
    for (std::string key, unit; info >> key;) {
        double kilobytes = 0;
        info >> kilobytes >> unit;
        if (key == "MemAvailable:") return kilobytes * 1024;
    }
    return std::numeric_limits<double>::infinity();
}

double needed_bytes(const MeshReport& mesh, double pitch, double spacing, double per_cell) {
    const Vec3 side = mesh.upper - mesh.lower;
    double octants = 1;
    for (int c = 0; c < 3; ++c) octants *= 2 * side[c] / pitch + 6;
    return bytes_per_octant * octants + bytes_per_node * estimate_nodes(mesh, spacing, per_cell);
}

}  // namespace

double estimate_nodes(const MeshReport& mesh, double spacing, double per_cell) {
    const double layer = spacing / std::cbrt(per_cell);
    return mesh.volume / (layer * layer * layer) + mesh.area / (2 * layer * layer);
}

void guard_memory(const MeshReport& mesh, double pitch, double spacing, double per_cell) {
    const double available = 0.9 * available_bytes();
    if (needed_bytes(mesh, pitch, spacing, per_cell) <= available) return;
    double workable = spacing;
    while (needed_bytes(mesh, workable * pitch / spacing, workable, per_cell) > available) workable *= 1.2;
    throw Error("a spacing of " + format_number(spacing) + " m would give this body about " +
                format_number(estimate_nodes(mesh, spacing, per_cell)) + " nodes, more than memory holds (" +
                format_number(std::floor(available / 1e6)) + " MB are free). Use a spacing of " +
                format_number(workable) + " m or more, or sampling.count");
}

}  // namespace phyxel
