#include "render/depth_map.h"

#include "render/shaders.h"

namespace phyxel {

DepthMap::DepthMap(int size, bool compare)
    : size_(size),
      shader_(shaders::depth_vertex(), shaders::depth_fragment()),
      texture_(make_texture(GL_DEPTH_COMPONENT24, size, size, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT)),
      framebuffer_(make_framebuffer()) {
    if (compare) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
}

void DepthMap::draw(const Vec3& eye, const Vec3& backward, const Vec3& up, double half_width, double depth,
                    const std::function<void(const Shader&)>& casters) {
    to_clip_ = parallel_matrix(half_width, depth) * view_matrix(eye, backward, up);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, size_, size_);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_DEPTH_BUFFER_BIT);
    shader_.use();
    shader_.set("to_clip", to_clip_);
    casters(shader_);
}

void DepthMap::bind(int unit) const {
    glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
    glBindTexture(GL_TEXTURE_2D, texture_);
}

}  // namespace phyxel
