#include "scene/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "scene/table_reader.h"

namespace phyxel {
namespace {

/// Where the value of KEY=VALUE goes: `KEY = 0` read as TOML is a chain of tables, one a segment.
std::vector<std::string> key_path(const SceneText& text, const std::string& key, const Place& place) {
    std::vector<std::string> path;
    try {
        const toml::table chain = toml::parse(key + " = 0", std::string_view());
        for (const toml::table* table = &chain; table;) {
            path.emplace_back(table->begin()->first.str());
            table = table->begin()->second.as_table();
        }
    } catch (const toml::parse_error&) {
        path.clear();
    }
    if (path.empty() || key.find_first_of("\n#[{") != key.npos)
        text.fail(place, "expected KEY=VALUE with a dotted key such as simulation.duration=1");
    return path;
}

/// The value, marked with the argument so that messages name it.
toml::table value_of(const std::string& value, const std::string& argument) {
    const auto parse = [&](const std::string& literal) {
        toml::table table = toml::parse("value = " + literal, std::string_view(argument));
        if (table.size() != 1) throw std::invalid_argument("more than a value");
        return table;
    };
    try {
        return parse(value);
    } catch (const std::exception&) {
        // No TOML value: a word without its quotes
    }
    toml::table table = parse("\"\"");
    *table["value"].as_string() = value;
    return table;
}

std::vector<std::string> labels(const toml::array& array) {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < array.size(); ++i) {
        const toml::table* table = array[i].as_table();
        const auto* name = table ? table->get_as<std::string>("name") : nullptr;
        all.push_back(name ? name->get() : std::to_string(i));
    }
    return all;
}

/// The element of a list that is called `label`, or has that index.
toml::node* element(toml::array& array, const std::string& label) {
    const std::vector<std::string> all = labels(array);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i] == label) return array.get(i);
    std::size_t index = 0;
    const char* end = label.data() + label.size();
    const bool is_index = std::from_chars(label.data(), end, index) == std::from_chars_result{end, std::errc()};
    return is_index && index < array.size() ? array.get(index) : nullptr;
}

/// Takes out what the file says in the place of `key`: who sets a spacing does not want the file's count.
void drop_alternatives(toml::table& table, const std::string& key) {
    static const std::pair<std::vector<std::string_view>, std::vector<std::string_view>> alternatives[] = {
        {{"spacing"}, {"count"}},
        {{"support"}, {"neighbors", "dilation"}},
        {{"force"}, {"traction", "pressure"}},
        {{"traction"}, {"pressure"}},
        {{"mesh"}, {"shape"}},
    };
    const auto has = [&](const std::vector<std::string_view>& keys) {
        return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    for (const auto& [one, other] : alternatives) {
        if (has(one))
            for (std::string_view k : other) table.erase(k);
        if (has(other))
            for (std::string_view k : one) table.erase(k);
    }
}

}  // namespace

void apply_override(const SceneText& text, toml::table& root, const std::string& argument) {
    // The key ends at the first '=' outside of quotes
    const Place place{.override = argument};
    std::size_t equals = 0;
    for (char quote = 0; equals < argument.size() && (quote || argument[equals] != '='); ++equals) {
        const char c = argument[equals];
        if (quote ? c == quote : c == '"' || c == '\'') quote = quote ? '\0' : c;
    }
    if (equals >= argument.size()) text.fail(place, "expected KEY=VALUE, found no '='");
    const std::string key = argument.substr(0, equals);
    if (key.size() > 500) text.fail(place, "expected a key of at most 500 letters");
    const std::vector<std::string> path = key_path(text, key, place);

    // Down to the table that holds the last key; tables that are missing are made, elements of lists are not
    toml::node* node = &root;
    std::string walked;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        walked += (i == 0 ? "" : ".") + path[i];
        if (toml::array* array = node->as_array()) {
            node = element(*array, path[i]);
            if (!node)
                text.fail({.field = walked, .override = argument},
                          fmt::format("there is no '{}' in this list{}", path[i], suggestion(path[i], labels(*array))));
        } else if (toml::table* table = node->as_table()) {
            table->insert(path[i], toml::table{});
            node = table->get(path[i]);
        } else {
            text.fail({.field = walked, .override = argument},
                      fmt::format("found {} above this key, expected a table", describe(*node)));
        }
    }

    toml::table value = value_of(argument.substr(equals + 1), argument);
    if (toml::table* table = node->as_table()) {
        drop_alternatives(*table, path.back());
        value.get("value")->visit([&](auto& concrete) { table->insert_or_assign(path.back(), std::move(concrete)); });
    } else {
        text.fail({.field = walked, .override = argument},
                  fmt::format("found {}, expected a table; an element of a list is set key by key, such as {}.0.name",
                              describe(*node), walked));
    }
}

}  // namespace phyxel
