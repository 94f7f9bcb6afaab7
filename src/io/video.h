#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "render/picture.h"

namespace phyxel {

/// Writes pictures as an MP4 file (H.264, yuv420p, BT.709, playable from the first byte), through the program `ffmpeg`.
/// The file appears whole at `finish`; before that, and when a writer is destroyed without it, there is none. The film
/// lasts pictures / frame_rate seconds. A width or height that is odd is made even by one black line of pixels.
///
/// Throws `Error` when ffmpeg is missing, when it ends early (disk full: with what it said), or when a picture has
/// another size. ffmpeg runs in its own process group: an interrupt from the keyboard reaches only the caller, which
/// can still finish the film.
class Mp4Writer {
public:
    Mp4Writer(std::filesystem::path path, int width, int height, double frame_rate);
    ~Mp4Writer();
    Mp4Writer(const Mp4Writer&) = delete;
    Mp4Writer& operator=(const Mp4Writer&) = delete;

    void add(const Picture& picture);
    /// Waits until ffmpeg has written the file. At least one picture must have been added.
    void finish();

private:
    void start(double frame_rate);
    void stop_feeding();
    int wait();
    std::string last_words() const;
    [[noreturn]] void fail();

    std::filesystem::path path_, temporary_;
    int width_, height_;
    std::size_t pictures_ = 0;
    pid_t process_ = -1;
    int frames_ = -1;    ///< socket to ffmpeg's standard input
    int messages_ = -1;  ///< file in memory with what ffmpeg says on its standard error
};

}  // namespace phyxel
