#include <fmt/format.h>

#include "scene/read_parts.h"

namespace phyxel {
namespace {

constexpr std::string_view example_box = "[[x, y, z], [x, y, z]]";

void read_directions(const TableReader& reader, Fix& fix) {
    const auto words = reader.strings("directions");
    if (!words) return;
    if (words->empty()) reader.fail("directions", "found an empty list, expected some of \"x\", \"y\", \"z\"");
    fix.x = fix.y = fix.z = false;
    for (const std::string& word : *words) {
        if (word != "x" && word != "y" && word != "z")
            reader.fail("directions", fmt::format("found \"{}\", expected some of \"x\", \"y\", \"z\"", word));
        (word == "x" ? fix.x : word == "y" ? fix.y : fix.z) = true;
    }
}

std::vector<GripKey> read_path(const TableReader& reader) {
    std::vector<GripKey> path;
    for (const TableReader& key : reader.list("path", {"time", "displacement", "degrees"})) {
        const double time = key.require(key.number("time", at_least(0, "s")), "time", "0.5 [s]");
        if (!path.empty() && time <= path.back().time)
            key.fail("time", fmt::format("found {:g} after {:g}, expected times that rise from key to key [s]", time,
                                         path.back().time));
        path.push_back({time, key.vector("displacement", any("m")).value_or(Vec3{}),
                        key.number("degrees", any("degrees")).value_or(0)});
    }
    if (path.empty())
        reader.fail("path",
                    "found an empty list, expected keyframes such as { time = 0.5, displacement = [0, 0, 0.1] }");
    return path;
}

/// How the grip moves: keyframes, or linearly to `displacement` and `rotation` at the end of the run.
void read_motion(const TableReader& reader, double duration, Fix& fix) {
    reader.not_both("displacement", "path");
    const Vec3 displacement = reader.vector("displacement", any("m")).value_or(Vec3{});
    double degrees = 0;
    if (const auto rotation = reader.table("rotation", {"axis", "center", "degrees"})) {
        fix.axis = rotation->direction("axis").value_or(fix.axis);
        fix.center = rotation->vector("center", any("m")).value_or(fix.center);
        degrees = rotation->number("degrees", any("degrees")).value_or(0);
        if (reader.has("path") && rotation->has("degrees"))
            rotation->fail("degrees", "found beside 'path', whose keyframes have their own 'degrees'; remove it");
    }
    if (reader.has("path")) fix.path = read_path(reader);
    else if (displacement != Vec3{} || degrees != 0) fix.path = {{0, {}, 0}, {duration, displacement, degrees}};
}

Load read_load(const TableReader& reader) {
    Load load;
    load.box = reader.require(reader.box("box"), "box", example_box);
    reader.exactly_one({"force", "traction", "pressure"});
    load.force = reader.vector("force", any("N"));
    load.traction = reader.vector("traction", any("Pa"));
    load.pressure = reader.number("pressure", any("Pa"));
    load.ramp = reader.number("ramp", at_least(0, "s")).value_or(0);
    return load;
}

std::variant<Plane, Sphere, Box> read_collider_shape(const TableReader& reader) {
    const double friction = reader.number("friction", at_least(0)).value_or(0.5);
    const std::string_view key = reader.exactly_one({"plane", "sphere", "box"});
    if (key == "plane") {
        const TableReader plane = *reader.table(key, {"point", "normal"});
        return Plane{plane.vector("point", any("m")).value_or(Vec3{}),
                     plane.direction("normal").value_or(Vec3{0, 1, 0}), friction};
    }
    if (key == "sphere") {
        const TableReader sphere = *reader.table(key, {"center", "radius"});
        return Sphere{sphere.vector("center", any("m")).value_or(Vec3{}),
                      sphere.require(sphere.number("radius", above(0, "m")), "radius", "0.1 [m]"), friction};
    }
    const TableReader box = *reader.table(key, {"center", "size", "rotation"});
    return Box{box.vector("center", any("m")).value_or(Vec3{}),
               box.require(box.vector("size", above(0, "m")), "size", "[x, y, z] [m], full sides"),
               box.rotation("rotation").value_or(AxisAngle{}), friction};
}

}  // namespace

std::vector<SceneFix> read_fixes(const TableReader& root, const std::vector<SceneBody>& bodies, double duration) {
    std::vector<SceneFix> fixes;
    Names names("fix");
    for (const TableReader& reader :
         root.list("fix", {"name", "body", "box", "directions", "displacement", "rotation", "path"})) {
        SceneFix fix{.name = names.take(reader), .body = reference(reader, "body", bodies), .fix = {}, .place = {}};
        fix.fix.box = reader.require(reader.box("box"), "box", example_box);
        fix.place = reader.place("box");
        read_directions(reader, fix.fix);
        read_motion(reader, duration, fix.fix);
        fixes.push_back(std::move(fix));
    }
    return fixes;
}

std::vector<SceneLoad> read_loads(const TableReader& root, const std::vector<SceneBody>& bodies) {
    std::vector<SceneLoad> loads;
    Names names("load");
    for (const TableReader& reader :
         root.list("load", {"name", "body", "box", "force", "traction", "pressure", "ramp"})) {
        std::string name = names.take(reader);
        const std::size_t body = reference(reader, "body", bodies);
        loads.push_back({std::move(name), body, read_load(reader), reader.place("box")});
    }
    return loads;
}

std::vector<SceneCollider> read_colliders(const TableReader& root) {
    std::vector<SceneCollider> colliders;
    Names names("collider");
    for (const TableReader& reader : root.list("collider", {"name", "plane", "sphere", "box", "friction"}, {"mesh"})) {
        std::string name = names.take(reader);
        colliders.push_back({std::move(name), read_collider_shape(reader), reader.place()});
    }
    return colliders;
}

std::vector<SceneProbe> read_probes(const TableReader& root, const std::vector<SceneBody>& bodies) {
    std::vector<SceneProbe> probes;
    Names names("probe");
    for (const TableReader& reader : root.list("probe", {"name", "body", "point"})) {
        std::string name = names.take(reader);
        const std::size_t body = reference(reader, "body", bodies);
        const Vec3 point = reader.require(reader.vector("point", any("m")), "point", "[x, y, z] [m], in rest space");
        probes.push_back({std::move(name), body, point, reader.place("point")});
    }
    return probes;
}

}  // namespace phyxel
