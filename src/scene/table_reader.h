#pragma once

#include <toml++/toml.h>
#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "phyxel/body.h"
#include "scene/scene_text.h"

namespace phyxel {

/// What a number may be.
struct Range {
    double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
    bool open_lower = false, open_upper = false;  ///< the bound itself is not allowed
    std::string_view unit = "";

    bool contains(double value) const;
    std::string text() const;  ///< "a number above 0 [m]"
};

inline Range any(std::string_view unit = "") { return {.unit = unit}; }
inline Range above(double lower, std::string_view unit = "") {
    return {.lower = lower, .open_lower = true, .unit = unit};
}
inline Range at_least(double lower, std::string_view unit = "") { return {.lower = lower, .unit = unit}; }
inline Range between(double lower, double upper, std::string_view unit = "") {
    return {.lower = lower, .upper = upper, .unit = unit};
}

/// A word of the scene language and what it stands for.
template <class T>
struct Choice {
    std::string_view word;
    T value{};
    bool available = true;  ///< false: a word of the contract that this version lacks
};

/// One table of a scene file, read key by key. All that is wrong with it is an `Error` that points at the place:
/// unknown keys (with the nearest known one), keys that this version lacks, wrong types, ranges, NaN and infinity.
/// A key that is absent reads as nothing, so that each default stands where it is used.
class TableReader {
public:
    /// Checks at once that every key of the table is in `known`; those in `later` are refused as not available yet.
    TableReader(const SceneText& text, const toml::table& table, std::string path,
                std::initializer_list<std::string_view> known, std::initializer_list<std::string_view> later = {});

    bool has(std::string_view key) const { return table_->contains(key); }
    bool is_string(std::string_view key) const { return has(key) && table_->get(key)->is_string(); }
    const std::string& path() const { return path_; }
    Place place() const;
    Place place(std::string_view key) const;  ///< of the value, or of the table when the key is absent

    std::optional<double> number(std::string_view key, const Range& range) const;
    std::optional<long> integer(std::string_view key, long lower, long upper) const;
    std::optional<bool> boolean(std::string_view key) const;
    std::optional<std::string> string(std::string_view key) const;               ///< not empty
    std::optional<Vec3> vector(std::string_view key, const Range& range) const;  ///< three numbers
    std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count, const Range& range) const;
    std::optional<Vec3> direction(std::string_view key) const;      ///< not zero; made a unit vector
    std::optional<AxisAngle> rotation(std::string_view key) const;  ///< { axis, degrees }
    std::optional<BoxSelection> box(std::string_view key) const;    ///< [[lower], [upper]], lower <= upper
    std::optional<std::vector<std::string>> strings(std::string_view key) const;  ///< each once

    /// The table under `key`.
    std::optional<TableReader> table(std::string_view key, std::initializer_list<std::string_view> known,
                                     std::initializer_list<std::string_view> later = {}) const;
    /// The tables of the list under `key`, `[[key]]`; each is called by its name, or by its index from 0.
    std::vector<TableReader> list(std::string_view key, std::initializer_list<std::string_view> known,
                                  std::initializer_list<std::string_view> later = {}) const;

    template <class T>
    std::optional<T> choice(std::string_view key, std::span<const Choice<T>> choices) const {
        const std::optional<std::string> word = string(key);
        if (!word) return {};
        return word_of(place(key), *word, choices);
    }

    /// What `word`, found at `where`, stands for.
    template <class T>
    T word_of(const Place& where, const std::string& word, std::span<const Choice<T>> choices) const {
        std::vector<std::string> words;
        for (const Choice<T>& c : choices) {
            if (c.available) words.emplace_back(c.word);
            if (c.word == word && !c.available) fail_not_available(where, word, choices);
            if (c.word == word) return c.value;
        }
        fail(where, "found \"" + word + "\", expected one of the known words" + suggestion(word, words));
    }

    /// The value of `read`, or an error that `key` is missing.
    template <class T>
    T require(std::optional<T> read, std::string_view key, std::string_view example) const {
        if (!read) fail_missing(key, example);
        return *std::move(read);
    }

    /// The one key of `keys` that is there; none or two of them are an error.
    std::string_view exactly_one(std::initializer_list<std::string_view> keys) const;
    /// At most one of two keys may be there.
    void not_both(std::string_view a, std::string_view b) const;

    [[noreturn]] void fail(const Place& place, std::string_view what) const { text_->fail(place, what); }
    [[noreturn]] void fail(std::string_view key, std::string_view what) const { fail(place(key), what); }

private:
    template <class T>
    [[noreturn]] void fail_not_available(const Place& where, const std::string& word,
                                         std::span<const Choice<T>> choices) const {
        std::string words;
        for (const Choice<T>& c : choices)
            if (c.available) words += (words.empty() ? "\"" : ", \"") + std::string(c.word) + "\"";
        fail(where, "\"" + word + "\" is not available yet in this version; use one of " + words);
    }
    [[noreturn]] void fail_missing(std::string_view key, std::string_view example) const;
    [[noreturn]] void fail_type(const Place& place, const toml::node& node, std::string_view expected) const;

    std::string field(std::string_view key) const;
    Place place_of(const toml::source_region& source, std::string field) const;
    double number_of(const toml::node& node, const std::string& field, const Range& range) const;
    std::vector<double> numbers_of(const toml::node& node, const std::string& field, std::size_t count,
                                   const Range& range) const;
    void check_keys(std::initializer_list<std::string_view> known, std::initializer_list<std::string_view> later) const;

    const SceneText* text_;
    const toml::table* table_;
    std::string path_;
};

/// "a string", "a number", "a list of 2", ...
std::string describe(const toml::node& node);

}  // namespace phyxel
