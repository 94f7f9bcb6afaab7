#include <random>

#include "scene_file.h"

namespace phyxel {
namespace {

/// One thing that is wrong with `good_scene`, and what the message must say.
struct WrongScene {
    const char *from, *to;
    const char* line;  ///< "LINE:COLUMN", where a user must look
    std::vector<const char*> says;
};

const WrongScene wrong_scenes[] = {
    // Syntax
    {"duration   = 0.5", "duration   = ", "6:14", {"not valid TOML"}},
    {"duration   = 0.5", "duration   = 0.5 0.6", "6:18", {"not valid TOML"}},
    {"[simulation]", "[simulation", "3:12", {"not valid TOML"}},
    {"duration   = 0.5", "duration = 1\nduration = 2", "7:1", {"not valid TOML"}},
    {"title = \"Everything\"", "title = \"Everything", "1:", {"not valid TOML"}},
    // Unknown keys
    {"[simulation]", "[simulatoin]", "3:2", {"unknown key 'simulatoin'", "did you mean 'simulation'"}},
    {"duration   = 0.5", "duratoin   = 0.5", "6:1", {"'simulation.duratoin'", "did you mean 'duration'"}},
    {"youngs_modulus", "young_modulus", "15:1", {"'material.jelly.young_modulus'", "did you mean 'youngs_modulus'"}},
    {"spacing = 0.01", "spacings = 0.01", "26:29", {"'body.beam.sampling.spacings'", "did you mean 'spacing'"}},
    {"friction", "roughness", "45:1", {"unknown key 'roughness'", "known: name, plane, sphere, box, friction"}},
    {"frame_rate", "zzzzzz", "7:1", {"unknown key 'zzzzzz'", "known: integrator, time_step"}},
    {"scale = 1.0",
     "region = [{ box = [[0, 0, 0], [1, 1, 1]], materal = \"jelly\" }]",
     "22:43",
     {"'body.beam.region.0.materal'", "did you mean 'material'"}},
    // The solver
    {"integrator = \"verlet\"",
     "integrator = \"bdf2\"\nsolver = { method = \"newtn\" }",
     "5:21",
     {"found \"newtn\"", "did you mean 'newton'"}},
    {"integrator = \"verlet\"", "integrator = \"bdf2\"\nsolver = { tolerance = 0.9 }", "5:24", {"found 0.9"}},
    {"integrator = \"verlet\"",
     "integrator = \"verlet\"\nsolver = { tolerance = 0.01 }",
     "5:10",
     {"explicit integrators solve nothing"}},
    {"integrator = \"verlet\"",
     "integrator = \"static\"\nsolver = { method = \"single-newton\" }",
     "5:21",
     {"finds no equilibrium"}},
    // Regions
    {"scale = 1.0",
     "region = [{ box = [[0, 0, 0], [1, 1, 1]], material = \"jely\" }]",
     "22:54",
     {"'body.beam.region.0.material'", "there is no material named \"jely\"", "did you mean 'jelly'"}},
    {"scale = 1.0",
     "region = [{ box = [[0, 0, 0], [1, 1, 1]] }]",
     "22:11",
     {"'body.beam.region.0'", "'material' is missing"}},
    {"scale = 1.0",
     "region = [{ material = \"jelly\" }]",
     "22:11",
     {"expected one of 'box', 'sphere', 'mesh', found none"}},
    {"scale = 1.0",
     "region = [{ box = [[0, 0, 2], [1, 1, 1]], material = \"jelly\" }]",
     "22:19",
     {"lower corner above the upper one along z"}},
    {"scale = 1.0",
     "region = [{ sphere = { radius = 0 }, material = \"jelly\" }]",
     "22:33",
     {"'body.beam.region.0.sphere.radius'", "above 0 [m]"}},
    {"scale = 1.0",
     "region = [{ sphere = { radius = 1 }, part = \"core\", material = \"jelly\" }]",
     "22:45",
     {"belongs to 'mesh' only"}},
    {"scale = 1.0",
     "region = [{ sphere = { radius = 1 }, material = \"jelly\", transition = -1 }]",
     "22:71",
     {"'body.beam.region.0.transition'", "from 0 on [m]"}},
    {"quadrature = \"grid\"", "mean_dilatation = \"always\"", "27:19", {"'body.beam.mean_dilatation'", "\"always\""}},
    {"quadrature = \"grid\"",
     "quadrature = \"nodes\"\nmean_dilatation = true",
     "28:19",
     {"belongs to quadrature = \"grid\""}},
    // Types
    {"duration   = 0.5", "duration   = \"0.5\"", "6:14", {"'simulation.duration'", "found a string \"0.5\""}},
    {"gravity    = [0.0, -9.81, 0]", "gravity    = -9.81", "8:14", {"expected a list of 3 numbers [m/s^2]"}},
    {"gravity    = [0.0, -9.81, 0]", "gravity    = [0, -9.81]", "8:14", {"found a list of 2"}},
    {"gravity    = [0.0, -9.81, 0]", "gravity = [0, \"g\", 0]", "8:15", {"'simulation.gravity[1]'", "found a string"}},
    {"[[material]]", "[material]", "11:1", {"'material'", "found a table, expected a list of tables, [[material]]"}},
    {"name = \"jelly\"", "name = 7", "12:8", {"'material.0.name'", "found 7, expected a string"}},
    {"damping    = { mass = 0.25, stiffness = 1e-3 }", "damping = true", "9:11", {"found true, expected a table"}},
    {"duration   = 0.5", "duration   = 2020-01-01", "6:14", {"found a date or time"}},
    {"[\"vtu\", \"ply\"]", "\"vtu\"", "53:11", {"expected a list of strings"}},
    // Range
    {"duration   = 0.5", "duration   = 0", "6:14", {"found 0, expected a number above 0 [s]"}},
    {"duration   = 0.5", "duration   = nan", "6:14", {"found nan"}},
    {"duration   = 0.5", "duration   = inf", "6:14", {"found inf"}},
    {"duration   = 0.5", "duration   = 1e30", "6:14", {"frames", "lower one of the two"}},
    {"frame_rate = 30", "frame_rate = -30", "7:14", {"found -30"}},
    {"\"auto\"", "-1e-3", "5:14", {"'simulation.time_step'", "above 0 [s]"}},
    {"\"auto\"", "\"large\"", "5:14", {"found \"large\""}},
    {"mass = 0.25", "mass = -1", "9:23", {"'simulation.damping.mass'", "from 0 on [1/s]"}},
    {"density = 1000", "density = 0", "14:11", {"'material.jelly.density'", "found 0"}},
    {"2.0e4", "-2.0e4", "15:18", {"'material.jelly.youngs_modulus'", "found -20000"}},
    {"2.0e4", "1e30", "15:18", {"found 1e+30", "[Pa]"}},
    {"0.45", "0.5", "16:18", {"'material.jelly.poissons_ratio'", "above -1 and below 0.5"}},
    {"scale = 1.0", "scale = 0", "22:9", {"'body.beam.scale'"}},
    {"spacing = 0.01", "spacing = -1", "26:39", {"'body.beam.sampling.spacing'", "found -1", "above 0 [m]"}},
    {"spacing = 0.01", "count = 3", "26:37", {"whole number from 4"}},
    {"spacing = 0.01", "count = 20.5", "26:37", {"found 20.5"}},
    {"support = 2.4", "support = 1", "28:42", {"from 1.2 up to 8 [spacings]"}},
    {"box = [0.04, 0.04, 0.2]", "box = [0.04, 0, 0.2]", "20:24", {"'body.beam.shape.box[1]'", "found 0"}},
    {"box = [0.04, 0.04, 0.2]", "torus = [0.1, 0.2]", "20:", {"minor radius", "below the major radius"}},
    {"axis = [0, 2, 0]", "axis = [0, 0, 0]", "23:21", {"zero vector"}},
    {"normal = [0, 3, 0]", "normal = [0, 0, 0]", "44:39", {"'collider.0.plane.normal'", "zero vector"}},
    {"friction = 0.25", "friction = -0.1", "45:12", {"'collider.0.friction'"}},
    {"[[-1, -1, -1], [1, 1, -0.05]]", "[[1, -1, -1], [-1, 1, 0]]", "33:7", {"'fix.grip.box'", "along x", "swap"}},
    {"[[-1, -1, -1], [1, 1, -0.05]]", "[1, 2, 3]", "33:7", {"expected two corners"}},
    {"ramp = 0.1", "ramp = -0.1", "41:8", {"'load.0.ramp'"}},
    // Words
    {"\"verlet\"", "\"verlett\"", "4:14", {"did you mean 'verlet'"}},
    {"\"corotated\"", "\"co-rotated\"", "13:7", {"did you mean 'corotated'"}},
    {"\"grid\"", "\"cells\"", "27:14", {"known: grid, nodes"}},
    {"\"wendland\"", "\"gauss\"", "28:20", {"quartic-spline"}},
    {"[\"x\", \"z\"]", "[\"w\"]", "34:14", {"\"x\", \"y\", \"z\""}},
    {"[\"x\", \"z\"]", "[\"x\", \"x\"]", "34:20", {"twice"}},
    {"[\"x\", \"z\"]", "[]", "34:14", {"empty list"}},
    {"[\"vtu\", \"ply\"]", "[\"vtk\"]", "53:11", {"did you mean 'vtu'"}},
    // References and names
    {"material = \"jelly\"", "material = \"jely\"", "21:12", {"no material named \"jely\"", "did you mean 'jelly'"}},
    {"body = \"beam\"\nbox = [[-1, -1, -1]", "body = \"b\"\nbox = [[-1, -1, -1]", "32:8", {"no body named", "beam"}},
    {"[[probe]]", "[[probe]]\nname = \"tip\"\nbody = \"beam\"\npoint = [0, 0.5, 0]\n[[probe]]", "52:8", {"twice"}},
    {"[[material]]", "[[material]]\nname = \"jelly\"\npreset = \"jelly\"\n[[material]]", "15:8", {"twice", "rename"}},
    {"density = 1000", "preset = \"steal\"", "14:10", {"did you mean 'steel'"}},
    // Missing and too many
    {"name = \"jelly\"", "", "11:1", {"'name' is missing"}},
    {"youngs_modulus = 2.0e4", "", "11:1", {"'youngs_modulus' is missing", "preset"}},
    {"material = \"jelly\"", "", "18:1", {"'material' is missing; add material = \"jelly\""}},
    {"shape = { box = [0.04, 0.04, 0.2] }", "", "18:1", {"expected one of 'mesh', 'shape', found none"}},
    {"shape = {", "mesh = \"a.obj\"\nshape = {", "21:9", {"found beside 'mesh'", "remove one"}},
    {"spacing = 0.01", "spacing = 0.01, count = 7", "26:53", {"found beside 'spacing'"}},
    {"support = 2.4", "support = 2.4, neighbors = 20", "28:59", {"found beside 'support'"}},
    {"support = 2.4", "dilation = 1.2", "28:43", {"add neighbors = 20"}},
    {"force = [0.0, -12.0, 0.0]", "", "37:1", {"expected one of 'force', 'traction', 'pressure'"}},
    {"force =", "pressure = 3\nforce =", "40:12", {"found beside 'force'"}},
    {"plane = { point = [0, 0, 0], normal = [0, 3, 0] }", "", "43:1", {"'plane', 'sphere', 'box'"}},
    {"point = [0.0, 0.5, 0.0]\n\n[out", "\n[out", "47:1", {"'point' is missing"}},
    {"law = \"corotated\"", "volume_stiffness = 2", "13:20", {"saint-venant-kirchhoff"}},
    {"displacement = [0.0, 0.0, 0.01]", "path = [{ time = 1 }, { time = 1 }]", "35:32", {"times that rise"}},
    {"displacement = [0.0, 0.0, 0.01]", "path = []", "35:8", {"empty list"}},
    // Of the contract, but later
    {"\"verlet\"", "\"constraint\"", "4:14", {"not available yet", "\"leap-frog\", \"verlet\""}},
    {"\"verlet\"", "\"auto\"", "4:14", {"not available yet"}},
    {"\"bcc\"", "\"octree\"", "26:22", {"not available yet", "\"cubic\", \"bcc\""}},
    {"density = 1000", "density = 1000\nplasticity = { yield_stress = 1e3 }", "15:1", {"not available yet"}},
    {"density = 1000", "density = 1000\nfracture = { toughness = 10 }", "15:1", {"not available yet"}},
    {"plane = { point = [0, 0, 0], normal = [0, 3, 0] }", "mesh = { file = \"a.obj\" }", "44:1", {"not available yet"}},
};

TEST(WrongScenes, each_is_refused_with_file_place_field_and_remedy) {
    TemporaryFolder folder;
    for (const WrongScene& row : wrong_scenes) {
        const auto path = folder.write("scene.toml", with(good_scene, row.from, row.to));
        const std::string message = refusal(path);
        const std::string start = path.string() + ":" + row.line;
        EXPECT_EQ(message.substr(0, start.size()), start) << row.to << "\n" << message;
        EXPECT_NE(message.find("^"), message.npos) << "no caret in: " << message;
        for (const char* expected : row.says)
            EXPECT_NE(message.find(expected), message.npos) << expected << "\n" << message;
    }
    EXPECT_GE(std::size(wrong_scenes), 40u);
}

TEST(WrongScenes, reading_writes_nothing) {
    TemporaryFolder folder;
    refusal(folder.write("scene.toml", with(good_scene, "scale = 1.0", "scale = -1")));
    std::size_t entries = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++entries;
    EXPECT_EQ(entries, 1u);
}

TEST(WrongScenes, files_that_are_no_scene_are_refused) {
    TemporaryFolder folder;
    EXPECT_NE(refusal(folder.path() / "none.toml").find("none.toml: cannot open"), std::string::npos);
    EXPECT_NE(refusal(folder.path()).find("found a folder"), std::string::npos);
    EXPECT_NE(refusal(folder.write("empty.toml", "")).find("found no body"), std::string::npos);
    EXPECT_NE(refusal(folder.write("comment.toml", "# nothing")).find("found no body"), std::string::npos);
    EXPECT_NE(refusal(folder.write("latin1.toml", "title = \"M\xfcller\"")).find("not valid TOML"), std::string::npos);
    EXPECT_NE(refusal(folder.write("nul.toml", std::string(100, '\0'))).find("not valid TOML"), std::string::npos);
    EXPECT_NE(refusal(folder.write("large.toml", std::string(17u << 20, ' '))).find("16 MB"), std::string::npos);
}

TEST(WrongScenes, deep_nesting_and_huge_numbers_do_not_crash_the_reader) {
    TemporaryFolder folder;
    std::string braces, dots = "a", tables = "[a";
    for (int i = 0; i < 100000; ++i) braces += "{a=", dots += ".a", tables += ".a";
    for (const std::string& text : {"x = " + std::string(100000, '['), "x = " + braces, dots + " = 1", tables + "]",
                                    "x = 1" + std::string(5000, '0'), "x = 1e" + std::string(5000, '9'),
                                    "x = 0." + std::string(100000, '1'), std::string(100000, '[')})
        EXPECT_NE(refusal(folder.write("deep.toml", text)), "") << text.substr(0, 20);
}

TEST(WrongScenes, binary_noise_and_damaged_scenes_do_not_crash_the_reader) {
    TemporaryFolder folder;
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        std::string noise(400, ' ');
        for (char& c : noise) c = static_cast<char>(random());
        EXPECT_NE(refusal(folder.write("noise.toml", noise)), "");
    }
    for (int i = 0; i < 500; ++i) {
        std::string damaged = good_scene;
        damaged[random() % damaged.size()] = static_cast<char>(random());
        damaged.erase(random() % damaged.size(), random() % 4);
        refusal(folder.write("damaged.toml", damaged));
    }
}

TEST(WrongScenes, a_caret_stands_under_the_value) {
    TemporaryFolder folder;
    const std::string message = refusal(folder.write("scene.toml", "[simulation]\nduration = -1 # too short\n"));
    EXPECT_NE(message.find("\n    2 | duration = -1 # too short\n      |            ^"), std::string::npos) << message;
}

}  // namespace
}  // namespace phyxel
