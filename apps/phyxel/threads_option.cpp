#include "commands.h"

namespace phyxel::cli {

void add_threads(CLI::App& command, int& threads) {
    command.add_option("--threads", threads, "Threads to use, 1 to 1024; the results do not depend on it")
        ->type_name("N")
        ->default_str("all of the machine's")
        ->check([](const std::string& text) {
            char* end = nullptr;
            const long value = std::strtol(text.c_str(), &end, 10);
            const bool good = !text.empty() && *end == '\0' && value >= 1 && value <= 1024;
            return good ? std::string() : "found '" + text + "', expected a whole number from 1 to 1024";
        });
}

}  // namespace phyxel::cli
