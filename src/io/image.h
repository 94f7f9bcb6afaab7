#pragma once

#include <filesystem>

#include "render/picture.h"

namespace phyxel {

/// Writes a picture as a PNG file, as a whole or not at all. `Error` when the file cannot be written.
void write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace phyxel
