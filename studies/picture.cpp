#include "studies/picture.h"

#include <spawn.h>
#include <sys/wait.h>

#include "base/atomic_file.h"
#include "plot_script.h"  // generated from plot.py

extern char** environ;

namespace phyxel::studies {
namespace {

constexpr int no_matplotlib = 3, no_program = 127;  ///< exit codes of the script, and of a program that is not there

/// Exit code of that Python with these arguments.
int run_python(std::string program, const std::string& script, const std::string& name, const std::string& folder) {
    std::string first = script, second = name, third = folder;
    char* arguments[] = {program.data(), first.data(), second.data(), third.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return no_program;
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

Drawing draw_picture(const std::string& name, const std::filesystem::path& folder) {
    const std::string script = folder / "plot.py";
    write_file(script, plot_script);
    int code = run_python("python3", script, name, folder);
    // Another Python may stand before the system's own, where its packages are.
    if (code == no_matplotlib) {
        const int second = run_python("/usr/bin/python3", script, name, folder);
        if (second != no_program) code = second;
    }
    if (code == 0) return {};
    const std::string later = "; later: python3 " + script + " " + name + " " + folder.string();
    if (code == no_program) return {false, "there is no python3 here" + later};
    if (code == no_matplotlib)
        return {false, "python3 lacks matplotlib (Debian: apt-get install python3-matplotlib)" + later};
    return {true, "the plotting script failed" + later};
}

}  // namespace phyxel::studies
