#include "progress_bar.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace phyxel::cli {
namespace {

constexpr double seconds_between = 0.1;  // redraws: often enough to look alive, too rare to cost anything

std::size_t terminal_width() {
    winsize size{};
    return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string clock(double seconds) {
    const auto whole = static_cast<long>(std::min(seconds, 3.5e6) + 0.5);
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

ProgressBar::ProgressBar() : is_terminal_(isatty(STDOUT_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (is_drawn_) fmt::print("\r\033[K");
}

void ProgressBar::show(const RunProgress& progress) {
    if (!is_terminal_ || progress.wall_seconds - last_drawn_ < seconds_between) return;
    last_drawn_ = progress.wall_seconds;
    is_drawn_ = true;
    fmt::print("\r\033[K{}", progress_line(progress, terminal_width() - 1));
    std::fflush(stdout);
}

std::string progress_line(const RunProgress& progress, std::size_t width) {
    const double done = progress.time / progress.duration;
    const double simulated = progress.time - progress.start;
    const double left = simulated > 0 ? progress.wall_seconds * (progress.duration - progress.time) / simulated : 0;
    const double rate = progress.wall_seconds > 0 ? static_cast<double>(progress.steps) / progress.wall_seconds : 0;
    const std::string text = fmt::format(" {:3.0f} %  {:.3g} of {:.3g} s  {:.0f} steps/s  {} left", 100 * done,
                                         progress.time, progress.duration, rate, clock(left));
    if (width < text.size() + 8) return text.substr(0, width);
    const std::size_t cells = std::min<std::size_t>(40, width - text.size() - 2);
    const auto full = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * static_cast<double>(cells));
    return "[" + std::string(full, '#') + std::string(cells - full, '.') + "]" + text;
}

}  // namespace phyxel::cli
