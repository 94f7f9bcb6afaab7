#include "scene/table_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace phyxel {

bool Range::contains(double value) const {
    return (open_lower ? value > lower : value >= lower) && (open_upper ? value < upper : value <= upper);
}

std::string Range::text() const {
    std::string text = "a finite number";
    const bool low = std::isfinite(lower), high = std::isfinite(upper);
    const std::string_view upper_word = open_upper ? "and below" : open_lower ? "and up to" : "up to";
    if (low && high)
        text = fmt::format("a number {} {:g} {} {:g}", open_lower ? "above" : "from", lower, upper_word, upper);
    else if (low)
        text = fmt::format("a number {} {:g}", open_lower ? "above" : "from", lower) + (open_lower ? "" : " on");
    else if (high) text = fmt::format("a number {} {:g}", open_upper ? "below" : "up to", upper);
    return unit.empty() ? text : fmt::format("{} [{}]", text, unit);
}

std::string describe(const toml::node& node) {
    if (const auto* string = node.as_string())
        return string->get().size() <= 40 ? fmt::format("a string \"{}\"", string->get()) : "a string";
    if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
    if (const auto* number = node.as_floating_point()) return fmt::format("{:.9g}", number->get());
    if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
    if (const auto* array = node.as_array()) return fmt::format("a list of {}", array->size());
    if (node.is_table()) return "a table";
    return "a date or time";
}

TableReader::TableReader(const SceneText& text, const toml::table& table, std::string path,
                         std::initializer_list<std::string_view> known, std::initializer_list<std::string_view> later)
    : text_(&text), table_(&table), path_(std::move(path)) {
    check_keys(known, later);
}

void TableReader::check_keys(std::initializer_list<std::string_view> known,
                             std::initializer_list<std::string_view> later) const {
    const auto is_in = [](std::initializer_list<std::string_view> keys, std::string_view key) {
        return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    for (const auto& [key, node] : *table_) {
        if (is_in(known, key.str())) continue;
        // A key given by --set has no place of its own in the file: its value has
        const toml::source_region& source = key.source().begin ? key.source() : node.source();
        const Place where = place_of(source, field(key.str()));
        if (is_in(later, key.str())) fail(where, "not available yet in this version; remove it");
        fail(where, fmt::format("unknown key '{}'{}", key.str(),
                                suggestion(key.str(), std::vector<std::string>(known.begin(), known.end()))));
    }
}

std::string TableReader::field(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

Place TableReader::place_of(const toml::source_region& source, std::string field) const {
    Place place{.field = std::move(field)};
    if (source.path && !source.path->empty()) place.override = *source.path;
    if (source.begin) place.line = source.begin.line, place.column = source.begin.column;
    return place;
}

Place TableReader::place() const { return place_of(table_->source(), path_); }

Place TableReader::place(std::string_view key) const {
    const toml::node* node = table_->get(key);
    return place_of(node ? node->source() : table_->source(), field(key));
}

void TableReader::fail_missing(std::string_view key, std::string_view example) const {
    fail(place_of(table_->source(), path_), fmt::format("'{}' is missing; add {} = {}", key, key, example));
}

void TableReader::fail_type(const Place& place, const toml::node& node, std::string_view expected) const {
    fail(place, fmt::format("found {}, expected {}", describe(node), expected));
}

double TableReader::number_of(const toml::node& node, const std::string& field, const Range& range) const {
    if (!node.is_number()) fail_type(place_of(node.source(), field), node, range.text());
    const double value = *node.value<double>();
    if (!std::isfinite(value) || !range.contains(value)) fail_type(place_of(node.source(), field), node, range.text());
    return value;
}

std::vector<double> TableReader::numbers_of(const toml::node& node, const std::string& field, std::size_t count,
                                            const Range& range) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() != count)
        fail_type(
            place_of(node.source(), field), node,
            fmt::format("a list of {} numbers{}", count, range.unit.empty() ? "" : fmt::format(" [{}]", range.unit)));
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(number_of((*array)[i], fmt::format("{}[{}]", field, i), range));
    return values;
}

std::optional<double> TableReader::number(std::string_view key, const Range& range) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    return number_of(*node, field(key), range);
}

std::optional<long> TableReader::integer(std::string_view key, long lower, long upper) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    const double value = node->is_number() ? *node->value<double>() : NAN;
    if (!(value >= static_cast<double>(lower) && value <= static_cast<double>(upper)) || value != std::floor(value))
        fail_type(place(key), *node, fmt::format("a whole number from {} to {}", lower, upper));
    return static_cast<long>(value);
}

std::optional<bool> TableReader::boolean(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    if (!node->is_boolean()) fail_type(place(key), *node, "true or false");
    return *node->value<bool>();
}

std::optional<std::string> TableReader::string(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    const toml::value<std::string>* text = node->as_string();
    if (!text) fail_type(place(key), *node, "a string in quotes");
    if (text->get().empty()) fail(key, "found an empty string, expected a text");
    if (std::any_of(text->get().begin(), text->get().end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }))
        fail(key, "found a control character, expected one line of printable text");
    return text->get();
}

std::optional<std::vector<std::string>> TableReader::strings(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    const toml::array* array = node->as_array();
    if (!array) fail_type(place(key), *node, "a list of strings");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < array->size(); ++i) {
        const toml::node& element = (*array)[i];
        const Place where = place_of(element.source(), fmt::format("{}[{}]", field(key), i));
        if (!element.is_string()) fail_type(where, element, "a string in quotes");
        const std::string word = element.as_string()->get();
        if (std::find(all.begin(), all.end(), word) != all.end())
            fail(where, fmt::format("found \"{}\" twice; remove one", word));
        all.push_back(word);
    }
    return all;
}

std::optional<std::vector<double>> TableReader::numbers(std::string_view key, std::size_t count,
                                                        const Range& range) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    return numbers_of(*node, field(key), count, range);
}

std::optional<Vec3> TableReader::vector(std::string_view key, const Range& range) const {
    const auto values = numbers(key, 3, range);
    if (!values) return {};
    return Vec3{(*values)[0], (*values)[1], (*values)[2]};
}

std::optional<Vec3> TableReader::direction(std::string_view key) const {
    const std::optional<Vec3> v = vector(key, any());
    if (!v) return {};
    const double largest = std::max({std::abs(v->x), std::abs(v->y), std::abs(v->z)});
    if (largest == 0) fail(key, "found a zero vector, expected a direction such as [0, 1, 0]");
    return normalized(*v / largest);
}

std::optional<AxisAngle> TableReader::rotation(std::string_view key) const {
    const auto rotation = table(key, {"axis", "degrees"});
    if (!rotation) return {};
    return AxisAngle{rotation->direction("axis").value_or(Vec3{0, 1, 0}),
                     rotation->number("degrees", any("degrees")).value_or(0)};
}

std::optional<BoxSelection> TableReader::box(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    const toml::array* corners = node->as_array();
    if (!corners || corners->size() != 2) fail_type(place(key), *node, "two corners, [[x, y, z], [x, y, z]] [m]");
    const auto corner = [&](std::size_t i) {
        const auto v = numbers_of((*corners)[i], fmt::format("{}[{}]", field(key), i), 3, any("m"));
        return Vec3{v[0], v[1], v[2]};
    };
    const BoxSelection box{corner(0), corner(1)};
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (box.lower[axis] > box.upper[axis])
            fail(key, fmt::format("found a lower corner above the upper one along {} ({:g} > {:g}); swap the two "
                                  "numbers",
                                  "xyz"[axis], box.lower[axis], box.upper[axis]));
    return box;
}

std::optional<TableReader> TableReader::table(std::string_view key, std::initializer_list<std::string_view> known,
                                              std::initializer_list<std::string_view> later) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    if (!node->is_table()) fail_type(place(key), *node, "a table, { key = value, ... }");
    return TableReader(*text_, *node->as_table(), field(key), known, later);
}

std::vector<TableReader> TableReader::list(std::string_view key, std::initializer_list<std::string_view> known,
                                           std::initializer_list<std::string_view> later) const {
    std::vector<TableReader> all;
    const toml::node* node = table_->get(key);
    if (!node) return all;
    const toml::array* array = node->as_array();
    if (!array) fail_type(place(key), *node, fmt::format("a list of tables, [[{}]]", key));
    for (std::size_t i = 0; i < array->size(); ++i) {
        const toml::node& element = (*array)[i];
        if (!element.is_table())
            fail_type(place_of(element.source(), fmt::format("{}.{}", field(key), i)), element, "a table");
        const toml::table& entry = *element.as_table();
        const auto* name = entry.get_as<std::string>("name");
        const std::string label = name && !name->get().empty() ? name->get() : std::to_string(i);
        all.emplace_back(*text_, entry, fmt::format("{}.{}", field(key), label), known, later);
    }
    return all;
}

std::string_view TableReader::exactly_one(std::initializer_list<std::string_view> keys) const {
    std::string_view found;
    std::string listed;
    for (const std::string_view key : keys) {
        listed += fmt::format("{}'{}'", listed.empty() ? "" : ", ", key);
        if (!has(key)) continue;
        if (!found.empty())
            fail(key, fmt::format("found beside '{}', expected only one of the two; remove one", found));
        found = key;
    }
    if (found.empty()) fail(place(), fmt::format("expected one of {}, found none; add one", listed));
    return found;
}

void TableReader::not_both(std::string_view a, std::string_view b) const {
    if (has(a) && has(b)) fail(b, fmt::format("found beside '{}', expected only one of the two; remove one", a));
}

}  // namespace phyxel
