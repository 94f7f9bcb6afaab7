#include "io/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

#include "phyxel/error.h"

extern char** environ;

namespace phyxel {
namespace {

void close_if_open(int& descriptor) {
    if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

/// What posix_spawn needs to know; freed with it.
struct SpawnSettings {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;

    SpawnSettings(int input, int errors) {
        posix_spawn_file_actions_init(&files);
        posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
        posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&files, errors, STDERR_FILENO);
        posix_spawnattr_init(&attributes);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setpgroup(&attributes, 0);
    }
    ~SpawnSettings() {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;
};

std::vector<std::string> arguments(int width, int height, double frame_rate, const std::filesystem::path& output) {
    // The filter says with which matrix sRGB becomes YCbCr, the tags tell the player the same.
    return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y",
            // raw pictures in
            "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", fmt::format("{}x{}", width, height),
            "-framerate", fmt::format("{:.10g}", frame_rate), "-i", "pipe:0",
            // a film that every player shows out
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-c:v",
            "libx264", "-preset", "fast", "-crf", "18", "-colorspace", "bt709", "-color_primaries", "bt709",
            "-color_trc", "iec61966-2-1", "-color_range", "tv", "-movflags", "+faststart", "-f", "mp4",
            "file:" + output.string()};
}

std::filesystem::path temporary_of(const std::filesystem::path& path) {
    std::string name = ".";
    name += path.filename().string();
    name += ".part";
    return path.parent_path() / name;
}

}  // namespace

Mp4Writer::Mp4Writer(std::filesystem::path path, int width, int height, double frame_rate)
    : path_(std::move(path)), temporary_(temporary_of(path_)), width_(width), height_(height) {
    if (!(frame_rate >= 0.001 && frame_rate <= 1e5))
        throw Error(
            fmt::format("cannot write {}: a film cannot have {} pictures a second; expected 0.001 to 1e5 "
                        "(simulation.frame_rate)",
                        path_.string(), frame_rate));
    try {
        start(frame_rate);
    } catch (...) {
        close_if_open(frames_);
        close_if_open(messages_);
        throw;
    }
}

void Mp4Writer::start(double frame_rate) {
    // A socket instead of a pipe: writing to it can be told not to raise SIGPIPE.
    std::array<int, 2> ends{-1, -1};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw Error("cannot write " + path_.string() + ": " + std::generic_category().message(errno));
    frames_ = ends[0];
    messages_ = ::memfd_create("ffmpeg-messages", MFD_CLOEXEC);

    std::vector<std::string> words = arguments(width_, height_, frame_rate, temporary_);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const SpawnSettings settings(ends[1], messages_);
    const int error =
        ::posix_spawnp(&process_, "ffmpeg", &settings.files, &settings.attributes, pointers.data(), environ);
    ::close(ends[1]);
    if (error == 0) return;
    process_ = -1;
    throw Error(
        fmt::format("cannot write {}: the program ffmpeg cannot be started ({}); install ffmpeg or leave mp4 "
                    "out of output.formats",
                    path_.string(), std::generic_category().message(error)));
}

Mp4Writer::~Mp4Writer() {
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        wait();
    }
    stop_feeding();
    close_if_open(messages_);
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void Mp4Writer::add(const Picture& picture) {
    if (picture.width != width_ || picture.height != height_)
        throw Error(fmt::format("cannot write {}: a picture of {} x {} pixels in a film of {} x {}", path_.string(),
                                picture.width, picture.height, width_, height_));
    const std::uint8_t* bytes = picture.rgb.data();
    for (std::size_t left = picture.rgb.size(); left > 0;) {
        const ssize_t sent = ::send(frames_, bytes, left, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) fail();
        bytes += sent;
        left -= static_cast<std::size_t>(sent);
    }
    ++pictures_;
}

void Mp4Writer::finish() {
    if (pictures_ == 0) throw Error("cannot write " + path_.string() + ": the film has no picture");
    stop_feeding();
    if (wait() != 0) fail();
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error) throw Error("cannot write " + path_.string() + ": " + error.message());
}

void Mp4Writer::stop_feeding() { close_if_open(frames_); }

/// Waits until ffmpeg ends; 0 when it says that all went well.
int Mp4Writer::wait() {
    int status = -1;
    while (process_ > 0 && ::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
}

/// The end of what ffmpeg said.
std::string Mp4Writer::last_words() const {
    std::array<char, 600> text{};
    const off_t size = ::lseek(messages_, 0, SEEK_END);
    const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
    const ssize_t count = ::pread(messages_, text.data(), text.size(), from);
    std::string words(text.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    while (!words.empty() && words.back() == '\n') words.pop_back();
    return words;
}

void Mp4Writer::fail() {
    stop_feeding();
    const int status = wait();
    std::string words = last_words();
    if (words.empty() && WIFSIGNALED(status)) words = fmt::format("ended by signal {}", WTERMSIG(status));
    throw Error(
        fmt::format("cannot write {}: ffmpeg failed: {}. Is the disk full, the folder writable? Else leave mp4 "
                    "out of output.formats",
                    path_.string(), words.empty() ? "no reason given" : words));
}

}  // namespace phyxel
