#pragma once

namespace phyxel {

/// An OpenGL 3.3 context without window or display, on EGL's surfaceless platform. Works as any user in any container
/// that has Mesa's software driver. Throws `Error` naming the missing package or driver.
class HeadlessContext {
public:
    HeadlessContext();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    /// Makes the context the calling thread's own for as long as the guard lives.
    class Guard {
    public:
        explicit Guard(const HeadlessContext& context);
        ~Guard();
        Guard(const Guard&) = delete;
        Guard& operator=(const Guard&) = delete;
    };

private:
    void* context_ = nullptr;
};

}  // namespace phyxel
