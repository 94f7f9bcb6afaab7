#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "phyxel/error.h"
#include "scene/scene_text.h"
#include "study_registry.h"

namespace phyxel::cli {
namespace {

std::string list_of_studies() {
    std::string text = "Studies, figures of Brunet et al. 2019:";
    for (const Study& study : all_studies())
        text +=
            fmt::format("\n  {:<18}{}{}", study.name, study.what, study.lacks.empty() ? "" : " (not available yet)");
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
    if (!study->lacks.empty())
        throw Error(fmt::format("study '{}' is not available yet: needs {}", name, study->lacks));
    if (options.folder.empty()) options.folder = std::filesystem::path("output") / name;
    return study->run(options);
}

}  // namespace

void add_study(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string name, folder;
        studies::Options options;
    };
    auto* command = app.add_subcommand("study", "Runs a published experiment; 'study list' names them");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("NAME", arguments->name, "Which one, or list")->required();
    command->add_option("-o,--output", arguments->folder, "Folder for the table and the picture")
        ->type_name("DIR")
        ->default_str("output/NAME");
    command->add_flag("--small", arguments->options.small, "Small sizes: a few seconds");
    add_threads(*command, arguments->options.threads);
    command->footer(list_of_studies());
    command->callback([arguments, &exit_code] {
        arguments->options.folder = arguments->folder;
        exit_code = run_study(arguments->name, arguments->options);
    });
}

}  // namespace phyxel::cli
