#include <fmt/format.h>

#include <algorithm>

#include "phyxel/error.h"
#include "scene/overrides.h"
#include "scene/read_parts.h"
#include "scene/scene.h"

namespace phyxel {
namespace {

toml::table parse(const SceneText& text) {
    try {
        return toml::parse(text.text(), std::string_view());
    } catch (const toml::parse_error& error) {
        const toml::source_position at = error.source().begin;
        text.fail({.line = at.line, .column = at.column}, fmt::format("not valid TOML: {}", error.description()));
    }
}

}  // namespace

std::string Names::take(const TableReader& entry) {
    const std::string name = entry.string("name").value_or(fmt::format("{}{}", kind_, count_));
    ++count_;
    if (!taken_.insert(name).second)
        entry.fail("name",
                   fmt::format("found \"{}\" twice among [[{}]], expected each name once; rename one", name, kind_));
    return name;
}

bool SceneOutput::writes(OutputFormat format) const {
    return std::find(formats.begin(), formats.end(), format) != formats.end();
}

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
    Scene scene;
    scene.text = std::make_shared<const SceneText>(read_scene_text(path));
    toml::table table = parse(*scene.text);
    for (const std::string& argument : overrides) apply_override(*scene.text, table, argument);

    const TableReader root(*scene.text, table, "",
                           {"title", "simulation", "material", "body", "fix", "load", "collider", "probe", "output"});
    scene.name = path.stem().string();
    scene.title = root.string("title").value_or(scene.name);
    scene.simulation = read_simulation(root);
    scene.materials = read_materials(root);
    scene.bodies = read_bodies(root, scene.materials);
    scene.fixes = read_fixes(root, scene.bodies, scene.simulation.duration);
    scene.loads = read_loads(root, scene.bodies);
    scene.colliders = read_colliders(root);
    scene.probes = read_probes(root, scene.bodies);
    scene.output = read_output(root);
    return scene;
}

}  // namespace phyxel
