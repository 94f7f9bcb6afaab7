#pragma once

#include "geometry/bvh.h"
#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// Whether a straight line between two points crosses a surface. The mesh must outlive it. Safe to call from many
/// threads.
class LineOfSight {
public:
    explicit LineOfSight(const TriangleMesh& mesh) : mesh_(mesh), bvh_(build_bvh(mesh)) {}

    /// No triangle touches the segment ab; one that is met at its rim blocks.
    bool clear(const Vec3& a, const Vec3& b) const;

private:
    const TriangleMesh& mesh_;
    Bvh bvh_;
};

}  // namespace phyxel
