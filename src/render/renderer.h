#pragma once

#include <memory>

#include "render/picture.h"
#include "render/render_scene.h"

namespace phyxel {

/// Draws pictures without window or display. Throws `Error` naming the missing package when there is no OpenGL, or the
/// size when no picture can have it. Not to be used from two threads at once.
class Renderer {
public:
    Renderer(int width, int height);
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    int width() const;
    int height() const;
    Picture draw(const RenderScene& scene);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace phyxel
