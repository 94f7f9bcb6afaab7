/// phyxel - soft and breakable solids from bare surface meshes, on the command line.
///
/// Exit codes: 0 success; 2 a user's mistake, with one message on standard error; 1 anything else.

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "command_line.h"
#include "commands.h"
#include "phyxel/error.h"

namespace phyxel::cli {
namespace {

int complain(std::string_view message, ExitCode code) {
    fmt::print(stderr, "phyxel: {}\n", message);
    return code;
}

}  // namespace
}  // namespace phyxel::cli

int main(int argc, char** argv) {
    using namespace phyxel::cli;
    // A file or a pipe that takes no more is an error of writing, not the end of the program
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return run_command_line(argc, argv);
    } catch (const phyxel::Error& error) {
        return complain(error.what(), mistake);
    } catch (const std::bad_alloc&) {
        return complain("out of memory; raise the spacing of the bodies, or lower their count of nodes", failure);
    } catch (const std::exception& error) {
        return complain(fmt::format("internal error: {}", error.what()), failure);
    } catch (...) {
        return complain("internal error", failure);
    }
}
