#pragma once

#include <functional>

#include "render/gl_objects.h"

namespace phyxel {

/// The scene's solid things, seen in parallel from one direction: only how far away they are.
class DepthMap {
public:
    /// `size` pixels in both directions. `compare`: the texture answers whether a depth is in front of it, smoothed;
    /// else it gives the depth.
    DepthMap(int size, bool compare);

    /// Draws `casters` as seen from `eye` towards -backward, `half_width` to each side and `depth` far [m].
    void draw(const Vec3& eye, const Vec3& backward, const Vec3& up, double half_width, double depth,
              const std::function<void(const Shader&)>& casters);

    void bind(int unit) const;
    const Mat4f& to_clip() const { return to_clip_; }  ///< world to the map's clip space
    int size() const { return size_; }

private:
    int size_;
    Shader shader_;
    GlName texture_, framebuffer_;
    Mat4f to_clip_;
};

}  // namespace phyxel
