#pragma once

#include <filesystem>
#include <string>

namespace phyxel::studies {

/// Draws FOLDER/NAME.png from FOLDER/NAME.csv with `studies/plot.py`, which the program carries and leaves in the
/// folder as plot.py. Returns why there is no picture; empty when there is one.
std::string draw_picture(const std::string& name, const std::filesystem::path& folder);

}  // namespace phyxel::studies
