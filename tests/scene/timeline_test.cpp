#include "scene/timeline.h"

#include <gtest/gtest.h>

#include <vector>

namespace phyxel {
namespace {

struct Walk {
    std::vector<double> frames, stops;
};

Walk walk(const Timeline& timeline, double end, double from = 0) {
    Walk walk;
    for (double now = from; now < end * (1 - 1e-12);) {
        const Timeline::Stop stop = timeline.next(now);
        EXPECT_GT(stop.time, now);
        walk.stops.push_back(stop.time);
        if (stop.frame) {
            EXPECT_EQ(*stop.frame, timeline.frame_at(stop.time));
            walk.frames.push_back(stop.time);
        }
        if (walk.stops.size() > 100000) break;
        now = stop.time;
    }
    return walk;
}

TEST(Timeline, frames_come_at_their_rate_and_the_last_one_at_the_end) {
    const Walk even = walk(Timeline({.duration = 2, .frame_rate = 60}, 1), 2);
    ASSERT_EQ(even.frames.size(), 120u);
    EXPECT_EQ(even.frames[29], 0.5);
    EXPECT_EQ(even.frames.back(), 2);

    const Walk partial = walk(Timeline({.duration = 0.1, .frame_rate = 30}, 1), 0.1);
    ASSERT_EQ(partial.frames.size(), 3u);
    const Walk uneven = walk(Timeline({.duration = 0.11, .frame_rate = 30}, 1), 0.11);
    ASSERT_EQ(uneven.frames.size(), 4u);
    EXPECT_EQ(uneven.frames.back(), 0.11);
    EXPECT_EQ(walk(Timeline({.duration = 0.001, .frame_rate = 30}, 1), 0.001).frames, std::vector<double>{0.001});
}

TEST(Timeline, every_time_step_is_met_beside_the_frames) {
    const Walk both = walk(Timeline({.time_step = 0.04, .duration = 0.2, .frame_rate = 10}, 1), 0.2);
    const double expected[] = {0.04, 0.08, 0.1, 0.12, 0.16, 0.2};
    ASSERT_EQ(both.stops.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(both.stops[i], expected[i], 1e-15);
    EXPECT_EQ(both.frames.size(), 2u);
}

TEST(Timeline, a_step_that_divides_the_frames_adds_no_slivers) {
    for (const double rate : {24.0, 60.0, 7.0, 1e3})
        EXPECT_EQ(walk(Timeline({.time_step = 1 / rate / 3, .duration = 50 / rate, .frame_rate = rate}, 1), 50 / rate)
                      .stops.size(),
                  150u);
}

TEST(Timeline, long_stretches_are_cut_into_even_pieces) {
    const Walk pieces = walk(Timeline({.duration = 1, .frame_rate = 1}, 0.15), 1);
    ASSERT_EQ(pieces.stops.size(), 7u);
    for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(pieces.stops[i], (static_cast<double>(i) + 1) / 7, 1e-15);
}

TEST(Timeline, a_resumed_run_meets_the_stops_of_one_that_never_stopped) {
    const Timeline timeline({.time_step = 0.013, .duration = 1, .frame_rate = 30}, 0.004);
    const Walk whole = walk(timeline, 1);
    for (const std::size_t at : {0u, 17u, 100u}) {
        const Walk rest = walk(timeline, 1, whole.stops[at]);
        EXPECT_EQ(rest.stops, std::vector<double>(whole.stops.begin() + static_cast<long>(at) + 1, whole.stops.end()));
    }
}

}  // namespace
}  // namespace phyxel
