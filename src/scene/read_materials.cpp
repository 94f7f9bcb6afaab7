#include <fmt/format.h>

#include "scene/read_parts.h"

namespace phyxel {
namespace {

constexpr Choice<Law> laws[] = {
    {"neo-hookean", Law::neo_hookean},
    {"corotated", Law::corotated},
    {"linear", Law::linear},
    {"saint-venant-kirchhoff", Law::saint_venant_kirchhoff},
};

constexpr double largest = 1e20;  // no matter is denser or stiffer; beyond, products of doubles overflow

std::optional<Material> read_preset(const TableReader& reader) {
    const std::optional<std::string> name = reader.string("preset");
    if (!name) return {};
    std::vector<std::string> names;
    for (const Preset& preset : presets()) {
        if (preset.name == *name) return preset.material;
        names.emplace_back(preset.name);
    }
    reader.fail("preset", fmt::format("there is no preset named \"{}\"{}", *name, suggestion(*name, names)));
}

SceneMaterial read_material(const TableReader& reader, Names& names) {
    SceneMaterial entry;
    reader.require(reader.string("name"), "name", "\"jelly\"");
    entry.name = names.take(reader);

    // A preset gives the numbers, keys of their own override it, and without a preset all three are needed
    const std::optional<Material> preset = read_preset(reader);
    Material& material = entry.material;
    if (preset) material = *preset;
    const auto number = [&](std::string_view key, const Range& range, double fallback, std::string_view example) {
        const std::optional<double> value = reader.number(key, range);
        return preset ? value.value_or(fallback) : reader.require(value, key, example);
    };
    material.density = number("density", between(smallest_density, largest_density, "kg/m^3"), material.density,
                              "1000 [kg/m^3], or a preset");
    material.youngs_modulus = number("youngs_modulus", between(smallest_modulus, largest_modulus, "Pa"),
                                     material.youngs_modulus, "2e4 [Pa], or a preset");
    material.poissons_ratio =
        number("poissons_ratio", {.lower = -1, .upper = 0.5, .open_lower = true, .open_upper = true},
               material.poissons_ratio, "0.45, or a preset");

    material.law = reader.choice<Law>("law", laws).value_or(material.law);
    material.volume_stiffness =
        reader.number("volume_stiffness", between(0, largest, "Pa")).value_or(material.volume_stiffness);
    if (reader.has("volume_stiffness") && material.law != Law::saint_venant_kirchhoff)
        reader.fail("volume_stiffness",
                    "belongs to law = \"saint-venant-kirchhoff\" only; remove it or change the law");
    return entry;
}

}  // namespace

std::vector<SceneMaterial> read_materials(const TableReader& root) {
    std::vector<SceneMaterial> materials;
    Names names("material");
    for (const TableReader& reader : root.list(
             "material", {"name", "preset", "law", "density", "youngs_modulus", "poissons_ratio", "volume_stiffness"},
             {"plasticity", "fracture"}))
        materials.push_back(read_material(reader, names));
    return materials;
}

}  // namespace phyxel
