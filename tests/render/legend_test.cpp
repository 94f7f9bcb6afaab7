#include "render/legend.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/color_map.h"
#include "render/stroke_font.h"

namespace phyxel {
namespace {

std::string labels(const ColorScale& scale) {
    std::string all;
    for (const Tick& tick : ticks_of(scale).ticks) all += tick.label + " ";
    return all;
}

TEST(Legend, ticks_are_the_ends_and_round_numbers_between_them) {
    EXPECT_EQ(labels({0, 12500, "stress", "Pa"}), "0 2 4 6 8 10 12.5 ");
    EXPECT_EQ(labels({0, 1, "", ""}), "0 0.2 0.4 0.6 0.8 1 ");
    EXPECT_EQ(labels({-1, 1, "", "m"}), "-1 -0.5 0 0.5 1 ");
    EXPECT_EQ(labels({3, 3, "", "m"}), "3 ");
}

TEST(Legend, ticks_stand_where_their_values_are) {
    for (const Tick& tick : ticks_of({-40, 160, "", "m"}).ticks)
        EXPECT_NEAR(tick.place, (std::stod(tick.label) + 40) / 200, 1e-12);
}

TEST(Legend, large_and_small_units_get_a_prefix) {
    EXPECT_EQ(ticks_of({0, 12500, "stress", "Pa"}).heading, "stress [kPa]");
    EXPECT_EQ(ticks_of({0, 0.004, "displacement", "m"}).heading, "displacement [mm]");
    EXPECT_EQ(ticks_of({0, 2, "speed", "m/s"}).heading, "speed [m/s]");
    EXPECT_EQ(ticks_of({0, 2000, "area", "m^2"}).heading, "area [1e3 m^2]");
    EXPECT_EQ(ticks_of({0, 1, "J", ""}).heading, "J");
}

TEST(Legend, bar_shows_the_colour_map_from_its_lower_end_up) {
    const Canvas canvas = draw_legend({0, 1, "J", ""}, 720);
    const auto pixel = [&](int x, int y) {
        return canvas.pixels()[static_cast<std::size_t>(y) * static_cast<std::size_t>(canvas.width()) +
                               static_cast<std::size_t>(x)];
    };
    const Vec3f top = color_map(1), bottom = color_map(0);
    const int x = 28, below = canvas.height() - 21;
    EXPECT_NEAR(pixel(x, 52).r, top.x, 0.02);
    EXPECT_NEAR(pixel(x, below).b, bottom.z, 0.05);
}

TEST(ColorMap, ends_are_viridis_and_what_is_no_number_is_grey) {
    EXPECT_EQ(color_map(-1), (Vec3f{0.267004f, 0.004874f, 0.329415f}));
    EXPECT_EQ(color_map(2), (Vec3f{0.993248f, 0.906157f, 0.143936f}));
    EXPECT_EQ(color_map(std::nan("")), (Vec3f{0.5f, 0.5f, 0.5f}));
}

TEST(ColorMap, becomes_lighter_with_the_value) {
    const auto lightness = [](const Vec3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; };
    for (int i = 0; i < 100; ++i) EXPECT_LT(lightness(color_map(i / 100.0)), lightness(color_map((i + 1) / 100.0)));
}

TEST(StrokeFont, every_printable_character_but_space_leaves_ink_inside_its_width) {
    for (char c = '!'; c <= '~'; ++c) {
        const std::string text(1, c);
        Canvas canvas(80, 80);
        draw_text(canvas, 20, 50, 24, text, {0, 0, 0, 1});
        double ink = 0, outside = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 80; ++x) {
                const float a = canvas.pixels()[static_cast<std::size_t>(80 * y + x)].a;
                ink += a;
                if (x < 17 || x > 22 + text_width(text, 24)) outside += a;
            }
        EXPECT_GT(ink, 5) << c;
        EXPECT_EQ(outside, 0) << c;
    }
}

TEST(StrokeFont, text_is_as_wide_as_its_characters) {
    EXPECT_NEAR(text_width("kPa", 12), text_width("k", 12) + text_width("P", 12) + text_width("a", 12), 1e-12);
    EXPECT_EQ(text_width("\xc3\xa9", 12), 0);
}

}  // namespace
}  // namespace phyxel
