#include "shell.h"

namespace phyxel {
namespace {

using RunCommand = Shell;

bool holds_no_nan(const std::string& text) {
    return text.find("nan") == text.npos && text.find("inf") == text.npos && text.find("null") == text.npos;
}

TEST_F(RunCommand, a_run_leaves_what_the_contract_says) {
    write("small.toml", small_scene);
    const Outcome outcome = shell("phyxel run small.toml --threads 2");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");

    const nlohmann::json found = summary("output/small");
    EXPECT_EQ(found["status"], "completed");
    EXPECT_EQ(found["message"], "");
    EXPECT_EQ(found["threads"], 2);
    EXPECT_EQ(found["scene"], "small.toml");
    EXPECT_NEAR(found["simulated_seconds"].get<double>(), 0.1, 1e-9);
    EXPECT_GT(found["steps"].get<int>(), 5);
    for (const char* key : {"version", "wall_seconds", "setup_seconds", "steps_per_second", "peak_memory_bytes",
                            "state_hash", "warnings", "fixes", "solver"})
        EXPECT_TRUE(found.contains(key)) << key;
    const nlohmann::json& block = found["bodies"]["block"];
    EXPECT_NEAR(block["mass"].get<double>(), 1, 1e-9);
    EXPECT_NEAR(block["mesh_volume"].get<double>(), 1e-3, 1e-12);
    EXPECT_EQ(block["fragments"], 1);
    for (const char* key : {"nodes", "quadrature_points", "mean_neighbors", "rest_volume", "volume"})
        EXPECT_GT(block[key].get<double>(), 0) << key;
    for (const char* key : {"kinetic", "elastic", "stabilization", "constraint", "gravitational", "plastic", "fracture",
                            "contact", "friction", "damping", "external_work", "numerical", "balance_error"})
        EXPECT_TRUE(found["energy"][key].is_number()) << key;
    EXPECT_EQ(found["probes"]["middle"]["rest"], nlohmann::json({0.0, 0.06, 0.0}));
    EXPECT_EQ(found["probes"]["middle"]["displacement"].size(), 3u);

    // One row and one surface a frame, the first and the last included
    const std::string rows = content(work() / "output/small/probes.csv");
    EXPECT_EQ(rows.substr(0, rows.find('\n')), "time,middle.x,middle.y,middle.z");
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 7);
    EXPECT_TRUE(holds_no_nan(rows));
    EXPECT_TRUE(std::filesystem::exists(work() / "output/small/frames/block.000000.ply"));
    EXPECT_TRUE(std::filesystem::exists(work() / "output/small/frames/block.000005.ply"));
    EXPECT_FALSE(std::filesystem::exists(work() / "output/small/frames/block.000006.ply"));
}

TEST_F(RunCommand, no_formats_leave_the_summary_and_the_probes_only) {
    write("small.toml", small_scene);
    ASSERT_EQ(shell("phyxel run small.toml -o out --set 'output.formats=[]'").code, 0);
    EXPECT_EQ(names(), (std::vector<std::string>{"out", "out/probes.csv", "out/summary.json", "small.toml"}));
}

TEST_F(RunCommand, every_frame_is_met_whatever_the_time_step) {
    write("small.toml", small_scene);
    const Outcome outcome = shell(
        "phyxel run small.toml -o out --set 'output.formats=[]' --set simulation.time_step=0.007 "
        "--set simulation.frame_rate=30");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::ifstream rows(work() / "out/probes.csv");
    std::string row;
    std::getline(rows, row);
    for (const double time : {0.0, 1.0 / 30, 2.0 / 30, 0.1}) {
        ASSERT_TRUE(std::getline(rows, row));
        EXPECT_NEAR(std::stod(row), time, 1e-12);
    }
    EXPECT_FALSE(std::getline(rows, row));
}

TEST_F(RunCommand, a_resumed_run_ends_with_the_same_bits_for_any_number_of_threads) {
    write("small.toml", small_scene);
    ASSERT_EQ(shell("phyxel run small.toml -o whole --threads 1").code, 0);
    ASSERT_EQ(shell("phyxel run small.toml -o parts --set simulation.duration=0.06 --threads 3").code, 0);
    const Outcome resumed = shell("phyxel run small.toml -o parts --resume parts/checkpoint.phyxel --threads 2");
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(summary("parts")["state_hash"], summary("whole")["state_hash"]);
    EXPECT_EQ(content(work() / "parts/probes.csv"), content(work() / "whole/probes.csv"));
    for (const char* frame : {"block.000002.ply", "block.000005.ply"})
        EXPECT_EQ(content(work() / "parts/frames" / frame), content(work() / "whole/frames" / frame));

    ASSERT_EQ(shell("phyxel run small.toml -o other --set body.block.velocity=[0,0,0.1]").code, 0);
    EXPECT_NE(summary("other")["state_hash"], summary("whole")["state_hash"]);
}

TEST_F(RunCommand, checkpoints_that_are_damaged_or_of_another_scene_are_refused) {
    write("small.toml", small_scene);
    ASSERT_EQ(shell("phyxel run small.toml -o out --set simulation.duration=0.04").code, 0);
    std::string bytes = content(work() / "out/checkpoint.phyxel");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write("damaged", bytes);
    write("cut", bytes.substr(0, 100));
    for (const char* line : {"--resume damaged", "--resume cut", "--resume small.toml", "--resume none",
                             "--resume out/checkpoint.phyxel --set material.jelly.youngs_modulus=2e4",
                             "--resume out/checkpoint.phyxel --set simulation.duration=0.04"}) {
        const Outcome outcome = shell(std::string("phyxel run small.toml -o new ") + line);
        EXPECT_EQ(outcome.code, 2) << line << "\n" << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(work() / "new")) << line;
    }
}

TEST_F(RunCommand, an_interrupted_run_leaves_whole_frames_and_can_go_on) {
    write("small.toml", small_scene);
    const std::string longer = "--set simulation.duration=1000";
    const Outcome outcome =
        shell("(exec '" PHYXEL_PROGRAM "' run small.toml -o out " + longer +
              ") & job=$!; "
              "for i in $(seq 200); do [ -e out/frames/block.000003.ply ] && break; sleep 0.05; done; "
              "kill -INT $job; wait $job");
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("stopped by the user"), std::string::npos) << outcome.err;
    EXPECT_EQ(summary("out")["status"], "interrupted");
    for (const std::string& name : names()) EXPECT_EQ(name.find(".part"), std::string::npos) << name;

    // Every surface that is there is whole: the same length as the first
    const auto size = std::filesystem::file_size(work() / "out/frames/block.000000.ply");
    for (const auto& entry : std::filesystem::directory_iterator(work() / "out/frames"))
        EXPECT_EQ(std::filesystem::file_size(entry.path()), size);
    const double time = summary("out")["simulated_seconds"];
    const std::string duration = std::to_string(time + 0.05);
    const Outcome resumed =
        shell("phyxel run small.toml -o out --resume out/checkpoint.phyxel --set simulation.duration=" + duration);
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    ASSERT_EQ(shell("phyxel run small.toml -o whole --set simulation.duration=" + duration).code, 0);
    EXPECT_EQ(summary("out")["state_hash"], summary("whole")["state_hash"]);
}

TEST_F(RunCommand, a_full_disk_ends_the_run_with_a_clear_message_and_no_half_file) {
    write("small.toml", small_scene);
    // Files above 4 blocks of 512 bytes are refused by the system, as on a full disk: the surface of the block is
    // larger
    const Outcome outcome = shell("ulimit -f 4; phyxel run small.toml -o out --set body.block.shape={sphere=0.05}");
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("cannot write"), std::string::npos) << outcome.err;
    for (const std::string& name : names()) {
        EXPECT_EQ(name.find(".part"), std::string::npos) << name;
        EXPECT_EQ(name.find(".ply"), std::string::npos) << name;
    }
}

TEST_F(RunCommand, fragments_are_plain_binary_surfaces) {
    write("small.toml", small_scene);
    ASSERT_EQ(shell("phyxel run small.toml -o out --fragments pieces").code, 0);
    const std::string ply = content(work() / "pieces/block.0.ply");
    EXPECT_EQ(ply.substr(0, ply.find("element vertex")), "ply\nformat binary_little_endian 1.0\n");
    EXPECT_NE(ply.find("property float x\nproperty float y\nproperty float z\nelement face"), std::string::npos);
    EXPECT_NE(ply.find("property list uchar int vertex_indices\nend_header\n"), std::string::npos);
}

}  // namespace
}  // namespace phyxel
