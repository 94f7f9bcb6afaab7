#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <exception>
#include <type_traits>

#include "phyxel/error.h"

/// Measurements in processes of their own.

namespace phyxel::bench {

/// Most memory that this process ever held [B].
inline double peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Time of all threads together, at work and in the system for it [s].
inline double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Runs `work(result)` in a process of its own, so that the peak memory of one size does not show in the next. `Result`
/// is plain bytes.
template <class Result, class Work>
Result in_child(Work&& work) {
    static_assert(std::is_trivially_copyable_v<Result>);
    struct Message {
        Result result;
        char error[256] = {};
    };
    std::array<int, 2> pipe_ends;
    if (pipe(pipe_ends.data()) != 0) throw Error("the benchmark could not open a pipe");
    const pid_t child = fork();
    if (child < 0) throw Error("the benchmark could not start a process");
    if (child == 0) {
        Message message;
        try {
            work(message.result);
        } catch (const std::exception& error) {
            std::strncpy(message.error, error.what(), sizeof message.error - 1);
        }
        const bool sent = ::write(pipe_ends[1], &message, sizeof message) == sizeof message;
        _exit(sent ? 0 : 1);
    }
    close(pipe_ends[1]);
    Message message;
    const bool received = ::read(pipe_ends[0], &message, sizeof message) == sizeof message;
    close(pipe_ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (!received) throw Error("the process that was measured died, for want of memory most likely");
    if (message.error[0] != 0) throw Error(message.error);
    return message.result;
}

}  // namespace phyxel::bench
