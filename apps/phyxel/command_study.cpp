#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "phyxel/error.h"
#include "scene/scene_text.h"
#include "study_registry.h"

namespace phyxel::cli {

std::string list_of_studies() {
    std::string text = "Studies, figures of Brunet et al. 2019:";
    for (const Study& study : all_studies()) text += fmt::format("\n  {:<18}{}", study.name, study.what);
    return text;
}

int run_study(const std::string& name, studies::Options options) {
    if (name == "list") {
        fmt::print("{}\n", list_of_studies());
        return success;
    }
    const std::vector<Study>& all = all_studies();
    const auto study = std::find_if(all.begin(), all.end(), [&](const Study& s) { return s.name == name; });
    if (study == all.end()) {
        std::vector<std::string> names = {"list"};
        for (const Study& s : all) names.emplace_back(s.name);
        throw Error(fmt::format("there is no study named '{}'{}", name, suggestion(name, names)));
    }
    if (options.folder.empty()) options.folder = std::filesystem::path("output") / name;
    return study->run(options);
}

}  // namespace phyxel::cli
