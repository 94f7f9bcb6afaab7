#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "phyxel/error.h"
#include "phyxel/material.h"

namespace phyxel {
namespace {

/// The message of the error that `action` throws; empty when it throws none.
template <class Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

void expect_mentions(const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
}

TEST(Presets, the_table_holds_eight_valid_materials_with_a_source) {
    for (const char* name : {"jelly", "rubber", "soft tissue", "wood", "steel", "concrete", "glass", "clay"}) {
        const Preset& preset = find_preset(name);
        EXPECT_EQ(preset.name, name);
        EXPECT_GE(preset.source.size(), 30U) << name;
        EXPECT_NO_THROW(validate(preset.material)) << name;
    }
    EXPECT_EQ(presets().size(), 8U);
}

TEST(Presets, an_unknown_name_is_refused_with_the_nearest_and_the_list) {
    expect_mentions(message_of([] { find_preset("stel"); }),
                    {"\"stel\"", "did you mean \"steel\"", "soft tissue, wood"});
    expect_mentions(message_of([] { find_preset("soft-tissue"); }), {"did you mean \"soft tissue\""});
    expect_mentions(message_of([] { find_preset("Jelly"); }), {"did you mean \"jelly\""});
    expect_mentions(message_of([] { find_preset(""); }), {"\"\" does not exist", "jelly, rubber"});
}

TEST(Validate, accepts_the_ends_of_the_useful_range) {
    EXPECT_NO_THROW(validate({.density = 1e-3, .youngs_modulus = 1e-3, .poissons_ratio = -0.99}));
    EXPECT_NO_THROW(validate({.density = 2e4, .youngs_modulus = 1e12, .poissons_ratio = 0.4999}));
    EXPECT_NO_THROW(validate(
        saint_venant_kirchhoff({.density = 1, .youngs_modulus = 1, .poissons_ratio = 0, .volume_stiffness = 5})));
}

TEST(Validate, names_field_value_and_range_of_what_is_wrong) {
    const Material good = {.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.3};
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const auto refused = [&](auto change) {
        Material bad = good;
        change(bad);
        return message_of([&] { validate(bad); });
    };
    for (const double value : {0.0, -5.0, nan, infinity}) {
        expect_mentions(refused([&](Material& m) { m.density = value; }), {"density is", "positive", "kg/m^3"});
        expect_mentions(refused([&](Material& m) { m.youngs_modulus = value; }),
                        {"youngs_modulus is", "positive", "Pa"});
    }
    for (const double value : {0.5, 0.6, -1.0, -2.0, nan, infinity})
        expect_mentions(refused([&](Material& m) { m.poissons_ratio = value; }),
                        {"poissons_ratio is", "above -1 and below 0.5"});
    expect_mentions(refused([](Material& m) { m.poissons_ratio = 0.7; }), {"0.7"});
    for (const double value : {-1.0, nan, infinity})
        expect_mentions(refused([&](Material& m) { m.volume_stiffness = value; }), {"volume_stiffness is", "zero"});
    expect_mentions(refused([](Material& m) { m.volume_stiffness = 3; }),
                    {"volume_stiffness", "saint-venant-kirchhoff"});
}

}  // namespace
}  // namespace phyxel
