#include "render/gl_objects.h"

#include "phyxel/error.h"

namespace phyxel {
namespace {

GlName compile(GLenum stage, const std::string& source) {
    GlName shader(glCreateShader(stage), [](GLuint name) { glDeleteShader(name); });
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    char log[2048] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw Error(std::string("Pictures cannot be drawn: the OpenGL driver refuses a shader. Update Mesa or the "
                            "graphics driver. It says: ") +
                log);
}

}  // namespace

GlName make_buffer() {
    GLuint name = 0;
    glGenBuffers(1, &name);
    return {name, [](GLuint n) { glDeleteBuffers(1, &n); }};
}

GlName make_vertex_array() {
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    return {name, [](GLuint n) { glDeleteVertexArrays(1, &n); }};
}

GlName make_framebuffer() {
    GLuint name = 0;
    glGenFramebuffers(1, &name);
    return {name, [](GLuint n) { glDeleteFramebuffers(1, &n); }};
}

GlName make_renderbuffer(GLenum format, int width, int height, int samples) {
    GLuint name = 0;
    glGenRenderbuffers(1, &name);
    glBindRenderbuffer(GL_RENDERBUFFER, name);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    return {name, [](GLuint n) { glDeleteRenderbuffers(1, &n); }};
}

GlName make_texture(GLenum format, int width, int height, GLenum upload_format, GLenum upload_type,
                    const void* pixels) {
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, upload_format, upload_type, pixels);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return {name, [](GLuint n) { glDeleteTextures(1, &n); }};
}

Shader::Shader(const std::string& vertex_source, const std::string& fragment_source)
    : program_(glCreateProgram(), [](GLuint name) { glDeleteProgram(name); }) {
    const GlName vertex = compile(GL_VERTEX_SHADER, vertex_source);
    const GlName fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
    glAttachShader(program_, vertex);
    glAttachShader(program_, fragment);
    glLinkProgram(program_);
    glDetachShader(program_, vertex);
    glDetachShader(program_, fragment);
}

void Shader::set(const char* uniform, int value) const { glUniform1i(glGetUniformLocation(program_, uniform), value); }

void Shader::set(const char* uniform, float value) const {
    glUniform1f(glGetUniformLocation(program_, uniform), value);
}

void Shader::set(const char* uniform, float x, float y) const {
    glUniform2f(glGetUniformLocation(program_, uniform), x, y);
}

void Shader::set(const char* uniform, const Vec3f& value) const {
    glUniform3f(glGetUniformLocation(program_, uniform), value.x, value.y, value.z);
}

void Shader::set(const char* uniform, const Mat4f& value) const {
    glUniformMatrix4fv(glGetUniformLocation(program_, uniform), 1, GL_FALSE, value.values.data());
}

GlMesh::GlMesh()
    : vertex_array_(make_vertex_array()),
      positions_(make_buffer()),
      normals_(make_buffer()),
      field_(make_buffer()),
      triangles_(make_buffer()) {}

void GlMesh::upload_attribute(GLuint attribute, const GlName& buffer, int components, const void* data,
                              std::size_t count) const {
    // An attribute without data reads zero for every vertex.
    if (count == 0) {
        glDisableVertexAttribArray(attribute);
        glVertexAttrib4f(attribute, 0, 0, 0, 0);
        return;
    }
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(float)) * components, data, GL_STREAM_DRAW);
    glVertexAttribPointer(attribute, components, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(attribute);
}

void GlMesh::upload(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const float> field,
                    std::span<const std::array<std::uint32_t, 3>> triangles) {
    glBindVertexArray(vertex_array_);
    upload_attribute(0, positions_, 3, positions.data(), positions.size());
    upload_attribute(1, normals_, 3, normals.data(), normals.size());
    upload_attribute(2, field_, 1, field.data(), field.size());
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, triangles_);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size_bytes()), triangles.data(),
                 GL_STREAM_DRAW);
    indices_ = static_cast<GLsizei>(3 * triangles.size());
}

void GlMesh::draw() const {
    glBindVertexArray(vertex_array_);
    glDrawElements(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace phyxel
