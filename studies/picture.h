#pragma once

#include <filesystem>
#include <string>

namespace phyxel::studies {

struct Drawing {
    bool failed = false;  ///< although Python and matplotlib are there
    std::string trouble;  ///< why there is no picture; empty when there is one
};

/// Draws FOLDER/NAME.png from FOLDER/NAME.csv with `studies/plot.py`, which the program carries and leaves in the
/// folder as plot.py.
Drawing draw_picture(const std::string& name, const std::filesystem::path& folder);

}  // namespace phyxel::studies
