#pragma once

#include "scene/run.h"

namespace phyxel::cli {

/// A bar with steps a second and time left, on one line that is drawn over and over; nothing at all when standard
/// output is no terminal.
class ProgressBar {
public:
    ProgressBar();
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void show(const RunProgress& progress);

private:
    bool is_terminal_;
    bool is_drawn_ = false;
    double last_drawn_ = -1;  // [s] of wall time
};

/// The bar's line, `width` characters at most.
std::string progress_line(const RunProgress& progress, std::size_t width);

}  // namespace phyxel::cli
