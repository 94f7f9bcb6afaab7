#include "geometry/mesh_measure.h"

namespace phyxel {

double surface_area(const TriangleMesh& mesh) {
    double twice = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        twice += norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
    return twice / 2;
}

double signed_volume(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return 0;
    const Vec3 origin = mesh.vertices[mesh.triangles[0][0]];
    double six_times = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        six_times += dot(mesh.vertices[a] - origin, cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin));
    return six_times / 6;
}

}  // namespace phyxel
