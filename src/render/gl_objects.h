#pragma once

#include <epoxy/gl.h>

#include <span>
#include <string>
#include <utility>

#include "render/matrix4.h"

namespace phyxel {

/// Owners of OpenGL's objects. Made, used and destroyed while their context is current.

/// The name of one object, deleted with it.
class GlName {
public:
    using Deleter = void (*)(GLuint);
    GlName() = default;
    GlName(GLuint name, Deleter deleter) : name_(name), deleter_(deleter) {}
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)), deleter_(other.deleter_) {}
    GlName& operator=(GlName&& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(deleter_, other.deleter_);
        return *this;
    }
    ~GlName() {
        if (name_) deleter_(name_);
    }
    operator GLuint() const { return name_; }

private:
    GLuint name_ = 0;
    Deleter deleter_ = nullptr;
};

GlName make_buffer();
GlName make_vertex_array();
GlName make_framebuffer();
/// A multisampled or plain image to draw into.
GlName make_renderbuffer(GLenum format, int width, int height, int samples);
/// A texture without content, interpolated, clamped to its edge.
GlName make_texture(GLenum format, int width, int height, GLenum upload_format, GLenum upload_type,
                    const void* pixels = nullptr);

/// A program of a vertex and a fragment shader. Setting a uniform that the compiler dropped does nothing.
class Shader {
public:
    Shader(const std::string& vertex_source, const std::string& fragment_source);

    void use() const { glUseProgram(program_); }
    void set(const char* uniform, int value) const;
    void set(const char* uniform, float value) const;
    void set(const char* uniform, float x, float y) const;
    void set(const char* uniform, const Vec3f& value) const;
    void set(const char* uniform, const Vec3& value) const { set(uniform, vector_cast<float>(value)); }
    void set(const char* uniform, const Mat4f& value) const;

private:
    GlName program_;
};

/// A surface on the graphics card. Attribute 0 is the position, 1 the normal, 2 the field.
class GlMesh {
public:
    GlMesh();
    void upload(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const float> field,
                std::span<const std::array<std::uint32_t, 3>> triangles);
    void draw() const;

private:
    void upload_attribute(GLuint attribute, const GlName& buffer, int components, const void* data,
                          std::size_t count) const;

    GlName vertex_array_, positions_, normals_, field_, triangles_;
    GLsizei indices_ = 0;
};

}  // namespace phyxel
