#include "scene/read_parts.h"

namespace phyxel {
namespace {

constexpr Choice<OutputFormat> formats[] = {
    {"vtu", OutputFormat::vtu}, {"ply", OutputFormat::ply}, {"obj", OutputFormat::obj},
    {"png", OutputFormat::png}, {"mp4", OutputFormat::mp4}, {"glb", OutputFormat::glb},
};
constexpr Choice<ColorBy> colors[] = {
    {"none", ColorBy::none},
    {"von-mises", ColorBy::von_mises},
    {"displacement", ColorBy::displacement},
};

void read_picture(const TableReader& output, SceneOutput& settings) {
    const auto reader = output.table("picture", {"width", "height"});
    if (!reader) return;
    // Video is coded in blocks of two by two pixels
    const auto even = [&](const char* key, int fallback) {
        const long pixels = reader->integer(key, 16, 8192).value_or(fallback);
        if (pixels % 2) reader->fail(key, "found an odd number of pixels, expected an even one");
        return static_cast<int>(pixels);
    };
    settings.width = even("width", settings.width);
    settings.height = even("height", settings.height);
}

std::optional<SceneCamera> read_camera(const TableReader& output) {
    const auto reader = output.table("camera", {"position", "target", "field_of_view"});
    if (!reader) return {};
    SceneCamera camera;
    camera.position = reader->require(reader->vector("position", any("m")), "position", "[x, y, z] [m]");
    camera.target = reader->require(reader->vector("target", any("m")), "target", "[x, y, z] [m]");
    camera.field_of_view = reader->number("field_of_view", between(1, 120, "degrees")).value_or(camera.field_of_view);
    if (camera.position == camera.target)
        reader->fail("target", "found the camera's own position, expected another point");
    return camera;
}

}  // namespace

SceneOutput read_output(const TableReader& root) {
    SceneOutput output;
    const auto reader = root.table("output", {"formats", "picture", "color_by", "camera", "checkpoint_every"});
    if (!reader) return output;
    if (const auto words = reader->strings("formats")) {
        output.formats.clear();
        for (const std::string& word : *words)
            output.formats.push_back(reader->word_of<OutputFormat>(reader->place("formats"), word, formats));
    }
    read_picture(*reader, output);
    output.color_by = reader->choice<ColorBy>("color_by", colors).value_or(output.color_by);
    output.camera = read_camera(*reader);
    output.checkpoint_every = reader->number("checkpoint_every", above(0, "s"));
    return output;
}

}  // namespace phyxel
