#include "render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "phyxel/error.h"
#include "render/headless_context.h"
#include "render/scene_painter.h"

namespace phyxel {

/// The painter is made and destroyed while the context is current.
struct Renderer::Parts {
    int width, height;
    HeadlessContext context;
    std::optional<ScenePainter> painter;

    Parts(int w, int h) : width(w), height(h) {
        const HeadlessContext::Guard guard(context);
        painter.emplace();
    }
    ~Parts() {
        const HeadlessContext::Guard guard(context);
        painter.reset();
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
};

Renderer::Renderer(int width, int height) {
    constexpr int smallest = 16, largest = 8192;
    if (std::min(width, height) < smallest || std::max(width, height) > largest)
        throw Error(
            fmt::format("A picture cannot be {} x {} pixels: expected {} to {} each way, for instance 1280 x 720.",
                        width, height, smallest, largest));
    parts_ = std::make_unique<Parts>(width, height);
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

int Renderer::width() const { return parts_->width; }
int Renderer::height() const { return parts_->height; }

Picture Renderer::draw(const RenderScene& scene) {
    const HeadlessContext::Guard guard(parts_->context);
    parts_->painter->draw(scene, parts_->width, parts_->height);

    // OpenGL's rows go from the bottom up.
    Picture upside_down{parts_->width, parts_->height, {}}, picture = upside_down;
    upside_down.rgb.resize(upside_down.row_bytes() * static_cast<std::size_t>(upside_down.height));
    picture.rgb.reserve(upside_down.rgb.size());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, parts_->painter->framebuffer());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, picture.width, picture.height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.rgb.data());
    for (int y = picture.height - 1; y >= 0; --y)
        picture.rgb.insert(picture.rgb.end(), upside_down.pixel(0, y), upside_down.pixel(0, y) + picture.row_bytes());
    return picture;
}

}  // namespace phyxel
