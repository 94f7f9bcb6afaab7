#pragma once

#include <toml++/toml.h>
#include <string>

#include "scene/scene_text.h"

namespace phyxel {

/// Sets one value of a parsed scene: `argument` is KEY=VALUE, where KEY is a dotted path. An element of a list is
/// called by its name or by its index from 0 (`body.bunny.scale`, `load.0.force`). VALUE is read as TOML, and as a
/// plain string when it is not; errors about it name the argument.
void apply_override(const SceneText& text, toml::table& root, const std::string& argument);

}  // namespace phyxel
