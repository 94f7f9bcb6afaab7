#pragma once

#include <set>

#include "scene/scene.h"
#include "scene/table_reader.h"

/// The parts of a scene file, one function a list; each is called once, in this order, by `read_scene`.

namespace phyxel {

SceneSimulation read_simulation(const TableReader& root);
std::vector<SceneMaterial> read_materials(const TableReader& root);
std::vector<SceneBody> read_bodies(const TableReader& root, const std::vector<SceneMaterial>& materials);
std::vector<SceneFix> read_fixes(const TableReader& root, const std::vector<SceneBody>& bodies, double duration);
std::vector<SceneLoad> read_loads(const TableReader& root, const std::vector<SceneBody>& bodies);
std::vector<SceneCollider> read_colliders(const TableReader& root);
std::vector<SceneProbe> read_probes(const TableReader& root, const std::vector<SceneBody>& bodies);
SceneOutput read_output(const TableReader& root);

/// Names of the entries of one list: each once, "body0", "body1", ... for those that have none.
class Names {
public:
    explicit Names(std::string kind) : kind_(std::move(kind)) {}
    std::string take(const TableReader& entry);

private:
    std::string kind_;
    std::set<std::string> taken_;
    std::size_t count_ = 0;
};

/// The index of the entry that `key` names.
template <class Entry>
std::size_t reference(const TableReader& reader, std::string_view key, const std::vector<Entry>& entries) {
    std::vector<std::string> names;
    for (const Entry& entry : entries) names.push_back(entry.name);
    const std::string name = reader.require(reader.string(key), key, names.empty() ? "\"NAME\"" : '"' + names[0] + '"');
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return i;
    reader.fail(key, "there is no " + std::string(key) + " named \"" + name + "\"" + suggestion(name, names));
}

}  // namespace phyxel
