#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace phyxel {

inline std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// What a command left: its exit code (128 + the signal when one ended it) and what it printed.
struct Outcome {
    int code = -1;
    std::string out, err;
};

/// A test with an empty folder of its own, in which its commands run.
class Shell : public testing::Test {
protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("phyxel_cli_" + std::to_string(getpid()) + "_" +
                                                      testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_ / "work");
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }

    /// Runs a line of shell in the working folder; `phyxel` is the program under test.
    Outcome shell(const std::string& line) const {
        const std::string out = folder_ / "out", err = folder_ / "err";
        const std::string command = "cd '" + work().string() + "' && phyxel() { '" PHYXEL_PROGRAM "' \"$@\"; }; { " +
                                    line + "\n} >'" + out + "' 2>'" + err + "' </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content(out), content(err)};
    }

    std::filesystem::path work() const { return folder_ / "work"; }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(work() / name, std::ios::binary) << text;
    }
    nlohmann::json summary(const std::string& folder) const {
        return nlohmann::json::parse(content(work() / folder / "summary.json"));
    }
    /// Names in the working folder, sorted.
    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(work()))
            all.push_back(std::filesystem::relative(entry.path(), work()).string());
        std::sort(all.begin(), all.end());
        return all;
    }

private:
    std::filesystem::path folder_;
};

/// A small block that falls beside a floor: a run of a fraction of a second.
inline const std::string small_scene = R"(
[simulation]
duration = 0.1
frame_rate = 50
[[material]]
name = "jelly"
density = 1000
youngs_modulus = 1e4
poissons_ratio = 0.4
[[body]]
name = "block"
shape = { box = [0.1, 0.1, 0.1] }
material = "jelly"
translation = [0, 0.06, 0]
sampling = { spacing = 0.02 }
[[collider]]
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
[[probe]]
name = "middle"
body = "block"
point = [0, 0.06, 0]
[output]
formats = ["ply"]
)";

}  // namespace phyxel
