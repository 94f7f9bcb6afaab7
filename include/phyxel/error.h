#pragma once

#include <stdexcept>
#include <string>

namespace phyxel {

/// What a user got wrong: a scene, a mesh, a setting, a path. The message names the file, line or field, what was
/// found, what was expected and how to mend it. Thrown while loading and writing, never while stepping.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace phyxel
