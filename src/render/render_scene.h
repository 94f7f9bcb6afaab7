#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "phyxel/body.h"
#include "phyxel/mesh.h"
#include "render/camera.h"

namespace phyxel {

/// A surface to draw. The spans must live until the picture is drawn.
struct RenderMesh {
    std::span<const Vec3f> positions;  ///< [vertices] [m]
    std::span<const Vec3f> normals;    ///< [vertices] unit; empty: each triangle its own
    std::span<const Triangle> triangles;
    Vec3f color{0.93f, 0.45f, 0.30f};  ///< sRGB, 0 to 1
    std::span<const float> field;      ///< [vertices] coloured by `RenderScene::scale`; empty: plain colour
};

/// What the colours of a field mean.
struct ColorScale {
    double lower = 0, upper = 1;  ///< the ends of the colour map; values beyond have the colour of the end
    std::string title;            ///< "von Mises stress"
    std::string unit;             ///< "Pa"; large and small values are written with a prefix, "kPa"; may be empty
};

/// All that is in a picture.
struct RenderScene {
    std::vector<RenderMesh> meshes;
    std::vector<Plane> planes;  ///< drawn on the side of their normal only; the first one is the floor
    std::vector<Sphere> spheres;
    std::vector<Box> boxes;
    Camera camera;
    std::optional<ColorScale> scale;  ///< with it, the legend is drawn
};

}  // namespace phyxel
