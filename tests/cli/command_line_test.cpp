#include "shell.h"

namespace phyxel {
namespace {

using CommandLine = Shell;

/// A mistake: exit code 2, one message on standard error, nothing on standard output.
void expect_mistake(const Outcome& outcome, const std::string& says) {
    EXPECT_EQ(outcome.code, 2) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.substr(0, 8), "phyxel: ") << outcome.err;
    EXPECT_EQ(outcome.err.find("\nphyxel: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << "expected: " << says << "\nfound: " << outcome.err;
}

TEST_F(CommandLine, help_and_version_succeed) {
    EXPECT_EQ(shell("phyxel --version").out, "phyxel 0.1.0\n");
    EXPECT_EQ(shell("phyxel --help").code, 0);
    for (const char* command : {"run", "check", "bench", "study", "view"}) {
        const Outcome outcome = shell(std::string("phyxel ") + command + " --help");
        EXPECT_EQ(outcome.code, 0) << command;
        EXPECT_NE(outcome.out.find("--threads"), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.err, "");
    }
}

TEST_F(CommandLine, wrong_arguments_are_mistakes) {
    write("scene.toml", small_scene);
    expect_mistake(shell("phyxel"), "--help");
    expect_mistake(shell("phyxel rum scene.toml"), "no command 'rum'; did you mean 'run'?");
    expect_mistake(shell("phyxel run"), "SCENE");
    expect_mistake(shell("phyxel run scene.toml --sett a=b"), "--sett");
    expect_mistake(shell("phyxel run scene.toml --threads 0"), "from 1 to 1024");
    expect_mistake(shell("phyxel run scene.toml --threads two"), "found 'two'");
    expect_mistake(shell("phyxel run scene.toml --set simulation.duration=-1"), "--set simulation.duration=-1");
    expect_mistake(shell("phyxel run scene.toml --set bodies.block.scale=1"), "unknown key 'bodies'");
    expect_mistake(shell("phyxel bench nothing"), "no benchmark named 'nothing'");
    expect_mistake(shell("phyxel study"), "NAME");
    expect_mistake(shell("phyxel view scene.toml"), "not available yet");
    expect_mistake(shell("phyxel check"), "MESH");
    expect_mistake(shell("phyxel check none.obj"), "none.obj");
    EXPECT_EQ(names(), std::vector<std::string>{"scene.toml"});
}

TEST_F(CommandLine, scenes_and_meshes_that_cannot_be_are_refused_and_leave_nothing) {
    const auto with = [](const char* from, const char* to) {
        std::string text = small_scene;
        return text.replace(text.find(from), std::string(from).size(), to);
    };
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("empty.obj", "");
    const std::string shape = "shape = { box = [0.1, 0.1, 0.1] }";
    const struct {
        std::string text, says;
    } rows[] = {
        {"", "found no body"},
        {std::string("\x7f"
                     "ELF\0\1\2",
                     7),
         "not valid TOML"},
        {with("1e4", "\"soft\""), "scene.toml:8:18: field 'material.jelly.youngs_modulus': found a string \"soft\""},
        {with("material = \"jelly\"", "material = \"jely\""), "did you mean 'jelly'"},
        {with(shape.c_str(), "mesh = \"none.obj\""), "none.obj"},
        {with(shape.c_str(), "mesh = \"empty.obj\""), "empty.obj"},
        {with(shape.c_str(), "mesh = \"flat.obj\""), "flat.obj"},
        {with(shape.c_str(), "mesh = \"cut.obj\""), "cut.obj"},
        {with(shape.c_str(), "mesh = \"nan.obj\""), "nan.obj"},
        {with(shape.c_str(), (shape + "\ncontact_mesh = \"none.obj\"").c_str()), "none.obj"},
        {with(shape.c_str(), (shape + "\ncontact_mesh = \"nan.obj\"").c_str()), "nan.obj"},
        {with(shape.c_str(), (shape + "\ncontact_mesh = \"flat.obj\"").c_str()),
         "scene.toml:13:16: field 'body.block.contact_mesh': body contact_mesh: "},
        {with(shape.c_str(), (shape + "\ncontact_mesh = \"flat.obj\"").c_str()),
         "vertex 2 at [0, 1.06, 0] is 0.95 m away"},
        {with(shape.c_str(), (shape + "\ncontact_mesh = \"flat.obj\"\ncontact_part = \"sole\"").c_str()), "sole"},
        {with(shape.c_str(), (shape + "\ncontact_part = \"sole\"").c_str()),
         "scene.toml:13:16: field 'body.block.contact_part': belongs to 'contact_mesh' only"},
        {with("spacing = 0.02", "spacing = 1e-7"), "scene.toml:15:24: field 'body.block.sampling.spacing'"},
        {with("spacing = 0.02", "spacing = 1e9"), "Use a spacing of 0.025 m or less"},
    };
    for (const auto& row : rows) {
        write("scene.toml", row.text);
        expect_mistake(shell("phyxel run scene.toml"), row.says);
        EXPECT_FALSE(std::filesystem::exists(work() / "output")) << row.says;
    }
}

TEST_F(CommandLine, selections_and_probes_that_miss_are_refused_at_their_place) {
    const std::string probe = "point = [0, 0.06, 0]";
    std::string outside = small_scene;
    outside.replace(outside.find(probe), probe.size(), "point = [0, 0.2, 0]");
    write("probe.toml", outside);
    expect_mistake(shell("phyxel run probe.toml"), "probe.toml:21:9: field 'probe.middle.point'");
    write("fix.toml", small_scene + "[[fix]]\nname = \"f\"\nbody = \"block\"\nbox = [[1, 1, 1], [2, 2, 2]]\n");
    expect_mistake(shell("phyxel run fix.toml"), "fix.toml:27:7: field 'fix.f.box'");
    write("load.toml", small_scene + "[[load]]\nbody = \"block\"\nbox = [[1, 1, 1], [2, 2, 2]]\nforce = [0, 0, 1]\n");
    expect_mistake(shell("phyxel run load.toml"), "load.toml:26:7: field 'load.0.box'");
    EXPECT_FALSE(std::filesystem::exists(work() / "output"));
}

TEST_F(CommandLine, an_output_that_cannot_be_written_is_a_mistake) {
    write("scene.toml", small_scene);
    write("file", "");
    expect_mistake(shell("phyxel run scene.toml -o file"), "file");
    expect_mistake(shell("phyxel run scene.toml -o file/below"), "file/below");
    expect_mistake(shell("phyxel run scene.toml -o /proc/phyxel"), "/proc/phyxel");
    EXPECT_EQ(content(work() / "file"), "");
}

TEST_F(CommandLine, check_reports_a_mesh_for_people_and_as_json) {
    const std::string bunny = PHYXEL_SOURCE_DIR "/scenes/meshes/bunny.obj";
    const Outcome text = shell("phyxel check " + bunny);
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("can be simulated   yes"), std::string::npos) << text.out;
    const Outcome json = shell("phyxel check --json " + bunny);
    EXPECT_EQ(json.code, 0);
    const nlohmann::json report = nlohmann::json::parse(json.out);
    EXPECT_EQ(report["triangles"], 3674);
    EXPECT_EQ(report["closed"], true);
    EXPECT_NEAR(report["volume"].get<double>(), 194.3, 0.05);
    EXPECT_EQ(report["spacings"].size(), 4u);
    // A hundredfold the nodes at about a fifth of the spacing
    EXPECT_NEAR(report["spacings"][3]["spacing"].get<double>() / report["spacings"][1]["spacing"].get<double>(), 0.2,
                0.03);
}

}  // namespace
}  // namespace phyxel
