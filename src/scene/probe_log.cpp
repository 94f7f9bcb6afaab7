#include "scene/probe_log.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "phyxel/error.h"

namespace phyxel {
namespace {

std::string quoted(const std::string& name) {
    if (name.find_first_of(",\"") == name.npos) return name;
    std::string text = "\"";
    for (const char c : name) text.append(c == '"' ? 2 : 1, c);
    return text + '"';
}

std::string header(const Scene& scene) {
    std::string line = "time";
    for (const SceneProbe& probe : scene.probes)
        for (const char axis : {'x', 'y', 'z'}) line += ',' + quoted(fmt::format("{}.{}", probe.name, axis));
    return line;
}

/// The rows of an earlier run of the same probes up to `time`.
std::string rows_up_to(const std::filesystem::path& path, const std::string& head, double time) {
    std::ifstream file(path);
    std::string line, rows;
    if (!std::getline(file, line) || line != head) return {};
    while (std::getline(file, line) && !file.eof() && std::strtod(line.c_str(), nullptr) <= time * (1 + 1e-9))
        rows += line + '\n';
    return rows;
}

}  // namespace

ProbeLog::ProbeLog(std::filesystem::path path, const Scene& scene, double resume_time) : path_(std::move(path)) {
    const std::string head = header(scene);
    const std::string kept = resume_time > 0 ? rows_up_to(path_, head, resume_time) : std::string();
    file_.open(path_, std::ios::binary | std::ios::trunc);
    file_ << head << '\n' << kept << std::flush;
    if (!file_)
        throw Error(
            fmt::format("cannot write {}: {}; choose another folder with -o", path_.string(), std::strerror(errno)));
}

void ProbeLog::add_row(const BuiltScene& built) {
    std::string row = fmt::format("{}", built.world.time());
    for (const std::size_t probe : built.probes) {
        const Vec3 x = built.world.probe(probe).position;
        row += fmt::format(",{},{},{}", x.x, x.y, x.z);
    }
    file_ << row << '\n' << std::flush;
    if (!file_)
        throw Error(fmt::format("cannot write {}: {}; free some space or choose another folder with -o", path_.string(),
                                std::strerror(errno)));
}

}  // namespace phyxel
