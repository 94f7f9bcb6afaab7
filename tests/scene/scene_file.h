#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "phyxel/error.h"
#include "scene/scene.h"

namespace phyxel {

/// A folder of its own for each test, removed with it.
class TemporaryFolder {
public:
    TemporaryFolder() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        path_ = std::filesystem::temp_directory_path() /
                ("phyxel_" + std::to_string(getpid()) + "_" + std::string(test->name()));
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& content) const {
        std::ofstream(path_ / name, std::ios::binary) << content;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

/// A scene that uses most of the contract's keys; tests change one thing of it.
inline const std::string good_scene = R"(title = "Everything"

[simulation]
integrator = "verlet"
time_step  = "auto"
duration   = 0.5
frame_rate = 30
gravity    = [0.0, -9.81, 0]
damping    = { mass = 0.25, stiffness = 1e-3 }

[[material]]
name = "jelly"
law = "corotated"
density = 1000
youngs_modulus = 2.0e4
poissons_ratio = 0.45

[[body]]
name = "beam"
shape = { box = [0.04, 0.04, 0.2] }
material = "jelly"
scale = 1.0
rotation = { axis = [0, 2, 0], degrees = 30 }
translation = [0.0, 0.5, 0.0]
velocity = [0, 0, 1]
sampling = { nodes = "bcc", spacing = 0.01 }
quadrature = "grid"
kernel = { shape = "wendland", support = 2.4 }

[[fix]]
name = "grip"
body = "beam"
box = [[-1, -1, -1], [1, 1, -0.05]]
directions = ["x", "z"]
displacement = [0.0, 0.0, 0.01]

[[load]]
body = "beam"
box = [[-1, -1, 0.05], [1, 1, 1]]
force = [0.0, -12.0, 0.0]
ramp = 0.1

[[collider]]
plane = { point = [0, 0, 0], normal = [0, 3, 0] }
friction = 0.25

[[probe]]
name = "tip"
body = "beam"
point = [0.0, 0.5, 0.0]

[output]
formats = ["vtu", "ply"]
)";

/// `text` with the one place that says `from` saying `to`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

/// The message of the `Error` that reading a scene gives; empty when it gives none.
inline std::string refusal(const std::filesystem::path& path, const std::vector<std::string>& overrides = {}) {
    try {
        read_scene(path, overrides);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace phyxel
