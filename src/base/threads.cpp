#include "base/threads.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <optional>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <thread>
#endif

namespace phyxel {

#ifdef __SANITIZE_THREAD__
namespace {

/// Stands in for oneTBB under the thread sanitizer, which cannot see how a library that was not built for it hands work
/// over: it would report every loop, and suppressing those reports would hide true ones.
void run_on_plain_threads(int count, std::size_t tasks, const Threads::Task& task) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t t; (t = next.fetch_add(1, std::memory_order_relaxed)) < tasks;) task(t);
    };
    std::vector<std::jthread> helpers;
    for (int h = 1; h < count; ++h) helpers.emplace_back(work);
    work();
}

}  // namespace
#endif

struct Threads::Pool {
    explicit Pool(int count) : arena(count) {
        // More threads than processors are legal, but oneTBB wants to be told.
        if (count > tbb::info::default_concurrency())
            allowed.emplace(tbb::global_control::max_allowed_parallelism, count);
    }
    std::optional<tbb::global_control> allowed;
    tbb::task_arena arena;
};

Threads::Threads(int count) : count_(count > 0 ? count : tbb::info::default_concurrency()) {
    if (count_ > 1) pool_ = std::make_unique<Pool>(count_);
}

Threads::Threads(ParallelFor parallel_for) : parallel_for_(std::move(parallel_for)), count_(0) {}

Threads::~Threads() = default;
Threads::Threads(Threads&&) noexcept = default;
Threads& Threads::operator=(Threads&&) noexcept = default;

void Threads::run(std::size_t tasks, const Task& task) const {
    if (parallel_for_) return parallel_for_(tasks, task);
    if (!pool_ || tasks < 2) {
        for (std::size_t t = 0; t < tasks; ++t) task(t);
        return;
    }
#ifdef __SANITIZE_THREAD__
    run_on_plain_threads(count_, tasks, task);
#else
    pool_->arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, tasks, [&](std::size_t t) { task(t); }, tbb::simple_partitioner{});
    });
#endif
}

}  // namespace phyxel
