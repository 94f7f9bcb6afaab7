#include "render/headless_context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <fmt/format.h>

#include "phyxel/error.h"

namespace phyxel {
namespace {

/// libepoxy ends the process when it cannot load a library: look first.
bool can_load(const char* library) {
    void* handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
    if (handle) dlclose(handle);
    return handle != nullptr;
}

[[noreturn]] void refuse(const char* what, const char* remedy) {
    throw Error(
        fmt::format("Pictures cannot be drawn: {}. {}, or leave png and mp4 out of output.formats.", what, remedy));
}

EGLDisplay open_display() {
    if (!can_load("libEGL.so.1")) refuse("the library libEGL.so.1 is missing", "Install the package libegl1");
    if (!can_load("libOpenGL.so.0") && !can_load("libGL.so.1"))
        refuse("the library libGL.so.1 is missing", "Install the package libgl1");
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        refuse("EGL has no surfaceless platform", "Install Mesa's EGL driver, package libegl-mesa0");
    EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
        refuse("no OpenGL driver could be started", "Install Mesa's software driver, package libgl1-mesa-dri");
    return display;
}

/// EGL has one surfaceless display a process, shared by all contexts; it stays open, since closing it would end those
/// of others.
EGLDisplay shared_display() {
    static const EGLDisplay display = open_display();
    return display;
}

}  // namespace

HeadlessContext::HeadlessContext() {
    EGLDisplay display = shared_display();
    const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    eglBindAPI(EGL_OPENGL_API);
    if (eglChooseConfig(display, config_attributes, &config, 1, &configs) && configs > 0)
        context_ = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    if (!context_)
        refuse("the OpenGL driver does not have version 3.3",
               "Install Mesa's software driver, package libgl1-mesa-dri");
}

HeadlessContext::~HeadlessContext() { eglDestroyContext(shared_display(), context_); }

HeadlessContext::Guard::Guard(const HeadlessContext& context) {
    eglBindAPI(EGL_OPENGL_API);
    if (!eglMakeCurrent(shared_display(), EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_))
        refuse("the OpenGL driver cannot draw without a surface", "Install Mesa's drivers, package libgl1-mesa-dri");
}

HeadlessContext::Guard::~Guard() { eglMakeCurrent(shared_display(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

}  // namespace phyxel
