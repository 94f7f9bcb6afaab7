#include "base/threads.h"

#include <gtest/gtest.h>

namespace phyxel {
namespace {

TEST(Threads, sums_are_the_same_bits_for_any_number_of_threads) {
    const auto term = [](std::size_t i) { return 1.0 / (1.0 + static_cast<double>(i)); };
    const double one = Threads(1).sum(100000, 512, term);
    for (int count : {2, 3, 8}) EXPECT_EQ(one, Threads(count).sum(100000, 512, term)) << count << " threads";
}

TEST(Threads, every_index_is_visited_once) {
    for (int count : {1, 2, 8}) {
        std::vector<int> visits(1003);
        Threads(count).for_each(visits.size(), 10, [&](std::size_t i) { ++visits[i]; });
        for (int v : visits) EXPECT_EQ(v, 1);
    }
}

TEST(Threads, the_callers_own_task_system_is_used) {
    std::size_t calls = 0;
    Threads threads([&](std::size_t count, const Threads::Task& task) {
        ++calls;
        for (std::size_t t = count; t-- > 0;) task(t);
    });
    EXPECT_EQ(threads.sum<double>(10, 3, [](std::size_t i) { return static_cast<double>(i); }), 45);
    EXPECT_EQ(calls, 1u);
}

}  // namespace
}  // namespace phyxel
