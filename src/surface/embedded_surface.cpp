#include "surface/embedded_surface.h"

namespace phyxel {

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.vertices[t[0]];
        const Vec3 area = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
        for (std::uint32_t v : t) normals[v] += area;
    }
    for (Vec3& n : normals) n = normalized(n);
    return normals;
}

EmbeddedSurface::EmbeddedSurface(const Model& model, const TriangleMesh& mesh, std::vector<Vec3> rest_normals,
                                 const Threads& threads)
    : rest_normals_(std::move(rest_normals)), triangles_(mesh.triangles) {
    const LatticeFrame& frame = model.sampling.frame;
    std::vector<Vec3> positions(mesh.vertices.size());
    std::vector<std::uint32_t> cells(mesh.vertices.size());
    threads.for_each(positions.size(), 256, [&](std::size_t v) {
        positions[v] = frame.to_lattice(mesh.vertices[v]);
        cells[v] = model.sampling.locate(positions[v], frame.direction_to_lattice(rest_normals_[v]));
    });
    points_ = embed(model.sampling, model.approximation, positions, cells, Gradients::yes, threads);
    positions_.resize(points_.size());
    normals_.resize(points_.size());
    update(model.rest, threads);
}

void EmbeddedSurface::update(std::span<const Vec3> x, const Threads& threads) {
    threads.for_each(points_.size(), 256, [&](std::size_t v) {
        positions_[v] = vector_cast<float>(points_.position(v, x));
        const Vec3 normal = normalized(cofactor(points_.deformation_gradient(v, x)) * rest_normals_[v]);
        normals_[v] = vector_cast<float>(norm_squared(normal) > 0 ? normal : rest_normals_[v]);
    });
}

}  // namespace phyxel
