#include "scene/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "phyxel/error.h"

namespace phyxel {
namespace {

constexpr std::size_t largest_file = 16u << 20;  // a scene is written by hand; this is a mesh given by mistake
constexpr std::size_t longest_chain = 32;        // segments of a dotted key; the parser recurses on them
constexpr std::size_t longest_quote = 110;       // characters of a line that a message shows

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The characters of a line, one string each; what is no printable text becomes '?'.
std::vector<std::string> characters(std::string_view line) {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < line.size();) {
        const auto byte = static_cast<unsigned char>(line[i]);
        const std::size_t length = byte < 0x80 ? 1 : byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC2 ? 2 : 0;
        bool whole = length > 0 && i + length <= line.size() && byte < 0xF5;
        for (std::size_t k = 1; whole && k < length; ++k) whole = is_continuation(line[i + k]);
        const bool printable = whole && (byte == '\t' || (byte >= 0x20 && byte != 0x7F));
        all.emplace_back(printable ? line.substr(i, length) : "?");
        i += whole ? length : 1;
    }
    return all;
}

std::string_view nth_line(std::string_view text, std::size_t line) {
    for (; line > 1; --line) {
        const std::size_t end = text.find('\n');
        if (end == text.npos) return {};
        text.remove_prefix(end + 1);
    }
    text = text.substr(0, text.find('\n'));
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
}

/// The line on which a key of more than `longest_chain` dotted segments stands; 0: none.
std::size_t line_of_endless_key(std::string_view text) {
    std::size_t line = 1, dots = 0;
    char quote = 0;
    bool comment = false;
    for (const char c : text) {
        if (c == '\n') {
            ++line, dots = 0, quote = 0, comment = false;
        } else if (comment) {
            continue;
        } else if (quote) {
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#') {
            comment = true;
        } else if (c == '.') {
            if (++dots > longest_chain) return line;
        } else if (c == ',' || c == '=' || c == '[' || c == ']' || c == '{' || c == '}') {
            dots = 0;
        }
    }
    return 0;
}

/// Edits that turn `a` into `b` (Damerau and Levenshtein, swaps of neighbours counted once).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

}  // namespace

std::string SceneText::message(const Place& place, std::string_view what) const {
    std::string text = path_.string();
    if (!place.override.empty()) text += fmt::format(": --set {}", place.override);
    else if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
    if (!place.field.empty()) text += fmt::format(": field '{}'", place.field);
    return fmt::format("{}: {}{}", text, what, quoted_line(place));
}

void SceneText::fail(const Place& place, std::string_view what) const { throw Error(message(place, what)); }

std::string SceneText::quoted_line(const Place& place) const {
    if (!place.override.empty() || place.line == 0) return {};
    const std::vector<std::string> line = characters(nth_line(text_, place.line));
    if (line.empty()) return {};

    // A window of the line around the column
    const std::size_t caret = std::min(place.column > 0 ? place.column - 1 : 0, line.size());
    const std::size_t begin = caret > longest_quote / 2 && line.size() > longest_quote ? caret - longest_quote / 2 : 0;
    const std::size_t end = std::min(line.size(), begin + longest_quote);
    std::string quoted = begin > 0 ? "..." : "", below = begin > 0 ? "   " : "";
    for (std::size_t i = begin; i < end; ++i) quoted += line[i];
    for (std::size_t i = begin; i < caret; ++i) below += line[i] == "\t" ? "\t" : " ";
    if (end < line.size()) quoted += "...";
    return fmt::format("\n{:5} | {}\n      | {}^", place.line, quoted, below);
}

SceneText read_scene_text(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        throw Error(fmt::format("{}: found a folder, expected a scene file (TOML)", path.string()));
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(fmt::format("{}: cannot open the scene file: {}; check the path, which is relative to '{}'",
                                path.string(), std::strerror(errno), std::filesystem::current_path(error).string()));

    std::string text(largest_file + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (file.bad()) throw Error(fmt::format("{}: cannot read the scene file: {}", path.string(), std::strerror(errno)));
    if (text.size() > largest_file)
        throw Error(
            fmt::format("{}: found more than 16 MB, expected a scene file (TOML); meshes are named in it by "
                        "'body.mesh'",
                        path.string()));

    SceneText scene(path, std::move(text));
    if (const std::size_t line = line_of_endless_key(scene.text()))
        scene.fail({.line = line, .column = 1},
                   fmt::format("found a key of more than {} dotted parts, expected 'a.b.c'", longest_chain));
    return scene;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    std::string best;
    std::size_t fewest = 1 + std::max<std::size_t>(2, word.size() / 3);
    if (word.size() > 64) return best;
    for (const std::string& candidate : candidates)
        if (const std::size_t d = edit_distance(word, candidate); d < fewest && d < candidate.size())
            best = candidate, fewest = d;
    return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates) {
    if (candidates.empty()) return "; there are none";
    std::string text;
    if (const std::string near = nearest(word, candidates); !near.empty())
        text = fmt::format("; did you mean '{}'?", near);
    const std::size_t shown = std::min<std::size_t>(candidates.size(), 20);
    for (std::size_t i = 0; i < shown; ++i)
        text += (i == 0 ? (text.empty() ? "; known: " : " Known: ") : ", ") + candidates[i];
    if (shown < candidates.size()) text += ", ...";
    return text;
}

}  // namespace phyxel
