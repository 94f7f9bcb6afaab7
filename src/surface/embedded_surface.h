#pragma once

#include "approximation/embedded_points.h"
#include "model/model.h"
#include "phyxel/world.h"

namespace phyxel {

/// The original surface mesh, carried along by the nodes: x = sum phi X, normals by cof(F) N, so that creases stay
/// creases.
class EmbeddedSurface final : public Surface {
public:
    /// `mesh` in rest space; `rest_normals` [vertices], unit, outward.
    EmbeddedSurface(const Model& model, const TriangleMesh& mesh, std::vector<Vec3> rest_normals,
                    const Threads& threads);

    void update(std::span<const Vec3> x, const Threads& threads);

    std::span<const Vec3f> positions() const override { return positions_; }
    std::span<const Vec3f> normals() const override { return normals_; }
    std::span<const Triangle> triangles() const override { return triangles_; }

    const EmbeddedPoints& points() const { return points_; }

private:
    EmbeddedPoints points_;
    std::vector<Vec3> rest_normals_;  ///< [vertices] rest space
    std::vector<Triangle> triangles_;
    std::vector<Vec3f> positions_, normals_;
};

/// [vertices] area-weighted normals, unit; zero where a vertex has no triangle.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh);

}  // namespace phyxel
