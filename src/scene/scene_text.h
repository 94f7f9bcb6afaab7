#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace phyxel {

/// Where a value of a scene comes from: what messages about it point at.
struct Place {
    std::string field{};               ///< "body.bunny.sampling.spacing"
    std::string override{};            ///< the `--set` argument that gave the value; empty: the file
    std::size_t line = 0, column = 0;  ///< in the file, from 1; 0: nowhere in it
};

/// The text of a scene file, kept so that every message can quote the line it is about.
class SceneText {
public:
    SceneText(std::filesystem::path path, std::string text) : path_(std::move(path)), text_(std::move(text)) {}

    const std::filesystem::path& path() const { return path_; }
    const std::string& text() const { return text_; }

    /// `FILE:LINE:COLUMN: field 'FIELD': WHAT`, then the line with a caret under the column; or
    /// `FILE: --set KEY=VALUE: field 'FIELD': WHAT`.
    std::string message(const Place& place, std::string_view what) const;

    /// Throws `Error` with that message.
    [[noreturn]] void fail(const Place& place, std::string_view what) const;

private:
    std::string quoted_line(const Place& place) const;

    std::filesystem::path path_;
    std::string text_;
};

/// Reads a scene file as text: at most 16 MB, and no chain of dotted keys that would exhaust the parser's stack.
/// Throws `Error` naming the file when it cannot be read.
SceneText read_scene_text(const std::filesystem::path& path);

/// The candidate nearest to `word`: fewest letters inserted, removed, changed or swapped; empty when none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'X'?" when some candidate is near, and the list of all of them, at most 20.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace phyxel
