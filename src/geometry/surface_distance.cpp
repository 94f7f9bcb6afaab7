#include "geometry/surface_distance.h"

namespace phyxel {

double SurfaceDistance::operator()(const Vec3& p, double reach) const {
    const double nearest = closest_point(mesh_, tree_, p, reach).distance;
    return winding_.inside(p) ? -nearest : nearest;
}

}  // namespace phyxel
