#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace phyxel {

/// Keeps a number that a test looked at beside its bound: on the screen, and as a property in gtest's XML.
inline void measured(const std::string& what, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "%.3g", value);
    std::printf("  measured: %s %s\n", what.c_str(), text);
    testing::Test::RecordProperty(what, text);
}

}  // namespace phyxel
