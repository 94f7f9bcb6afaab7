#include <fmt/format.h>

#include "approximation/stencils.h"
#include "scene/read_parts.h"

namespace phyxel {
namespace {

constexpr Choice<Lattice> lattices[] = {
    {"cubic", Lattice::cubic},
    {"bcc", Lattice::bcc},
    {"octree", Lattice::cubic, false},
    {"raster", Lattice::cubic, false},
};
constexpr Choice<Quadrature> quadratures[] = {{"grid", Quadrature::grid}, {"nodes", Quadrature::nodes}};
constexpr Choice<KernelShape> kernel_shapes[] = {
    {"quartic-spline", KernelShape::quartic_spline},
    {"poly6", KernelShape::poly6},
    {"cubic-spline", KernelShape::cubic_spline},
    {"wendland", KernelShape::wendland},
};

constexpr long most_nodes = 1'000'000'000;  // memory refuses far earlier, with the spacing that fits

Shape read_shape(const TableReader& reader) {
    const std::string_view key = reader.exactly_one({"box", "sphere", "cylinder", "torus"});
    const Range length = above(0, "m");
    if (key == "box") return BoxShape{*reader.vector(key, length)};
    if (key == "sphere") return SphereShape{*reader.number(key, length)};
    const std::vector<double> sizes = *reader.numbers(key, 2, length);
    if (key == "cylinder") return CylinderShape{sizes[0], sizes[1]};
    if (sizes[1] >= sizes[0])
        reader.fail(key, fmt::format("found a minor radius of {:g}, expected one below the major radius {:g} [m]",
                                     sizes[1], sizes[0]));
    return TorusShape{sizes[0], sizes[1]};
}

std::variant<MeshFile, Shape> read_surface(const TableReader& reader) {
    if (reader.exactly_one({"mesh", "shape"}) == "shape") {
        if (reader.has("part")) reader.fail("part", "belongs to 'mesh' only; remove it");
        return read_shape(*reader.table("shape", {"box", "sphere", "cylinder", "torus"}));
    }
    return MeshFile{*reader.string("mesh"), reader.string("part").value_or("")};
}

std::optional<MeshFile> read_contact_mesh(const TableReader& reader) {
    const std::optional<std::string> path = reader.string("contact_mesh");
    if (path) return MeshFile{*path, reader.string("contact_part").value_or("")};
    if (reader.has("contact_part")) reader.fail("contact_part", "belongs to 'contact_mesh' only; remove it");
    return {};
}

std::optional<TableReader> sampling_table(const TableReader& body) {
    return body.table("sampling", {"nodes", "spacing", "count", "rotation", "offset"});
}

void read_sampling(const TableReader& body, BodySettings& settings) {
    const auto reader = sampling_table(body);
    if (!reader) return;
    reader->not_both("spacing", "count");
    settings.lattice = reader->choice<Lattice>("nodes", lattices).value_or(settings.lattice);
    settings.spacing = reader->number("spacing", above(0, "m")).value_or(0);
    settings.count =
        static_cast<std::size_t>(reader->integer("count", 4, most_nodes).value_or(static_cast<long>(settings.count)));
    settings.lattice_rotation = reader->rotation("rotation").value_or(AxisAngle{});
    settings.lattice_offset = reader->vector("offset", any("spacings")).value_or(Vec3{});
}

void read_kernel(const TableReader& body, BodySettings& settings) {
    Kernel& kernel = settings.kernel;
    kernel.shape = kernel_shape(settings);
    const auto reader = body.table("kernel", {"shape", "support", "neighbors", "dilation"});
    if (!reader) return;
    reader->not_both("support", "neighbors");
    reader->not_both("support", "dilation");
    if (reader->has("dilation") && !reader->has("neighbors"))
        reader->fail("dilation", "belongs to 'neighbors' only; add neighbors = 20, or use support = 2.2");
    kernel.shape = reader->choice<KernelShape>("shape", kernel_shapes).value_or(*kernel.shape);
    kernel.support = reader->number("support", between(1.2, 8, "spacings")).value_or(0);
    kernel.neighbors = static_cast<int>(reader->integer("neighbors", 8, 1000).value_or(0));
    kernel.dilation = reader->number("dilation", between(1.01, 4)).value_or(kernel.dilation);
}

std::optional<bool> read_mean_dilatation(const TableReader& body) {
    constexpr std::string_view key = "mean_dilatation";
    constexpr Choice<std::optional<bool>> words[] = {{"auto", {}}};
    std::optional<bool> wanted;
    if (body.is_string(key)) body.choice<std::optional<bool>>(key, words);
    else wanted = body.boolean(key);
    if (wanted == true && body.has("quadrature") && body.string("quadrature") == "nodes")
        body.fail(key, "belongs to quadrature = \"grid\"; with points at the nodes a cell has a single one. Remove it");
    return wanted;
}

SceneRegion read_region(const TableReader& reader, const std::vector<SceneMaterial>& materials, Region& region) {
    SceneRegion entry;
    entry.place = reader.place();
    const std::string_view key = reader.exactly_one({"box", "sphere", "mesh"});
    if (key == "box") {
        const BoxSelection box = *reader.box(key);
        region.shape = BoxRegion{box.lower, box.upper};
    } else if (key == "sphere") {
        const TableReader sphere = *reader.table(key, {"center", "radius"});
        region.shape = SphereRegion{sphere.vector("center", any("m")).value_or(Vec3{}),
                                    sphere.require(sphere.number("radius", above(0, "m")), "radius", "0.1")};
    } else {
        region.shape = TriangleMesh{};  // read when the world is built
        entry.mesh = MeshFile{*reader.string(key), reader.string("part").value_or("")};
        entry.scale = reader.number("scale", above(0)).value_or(entry.scale);
        entry.rotation = reader.rotation("rotation").value_or(entry.rotation);
        entry.translation = reader.vector("translation", any("m")).value_or(entry.translation);
    }
    for (const std::string_view of_mesh : {"part", "scale", "rotation", "translation"})
        if (key != "mesh" && reader.has(of_mesh)) reader.fail(of_mesh, "belongs to 'mesh' only; remove it");
    entry.material = reference(reader, "material", materials);
    region.material = materials[entry.material].material;
    region.transition = reader.number("transition", at_least(0, "m")).value_or(0);
    return entry;
}

/// What messages about the number of nodes point at.
Place sampling_place(const TableReader& body) {
    const auto reader = sampling_table(body);
    if (!reader) return body.place();
    return reader->has("spacing") ? reader->place("spacing") : reader->place(reader->has("count") ? "count" : "nodes");
}

SceneBody read_body(const TableReader& reader, const std::vector<SceneMaterial>& materials, Names& names) {
    SceneBody body;
    body.name = names.take(reader);
    body.surface = read_surface(reader);
    body.contact_mesh = read_contact_mesh(reader);
    body.material = reference(reader, "material", materials);

    BodySettings& settings = body.settings;
    settings.name = body.name;
    settings.material = materials[body.material].material;
    settings.scale = reader.number("scale", above(0)).value_or(settings.scale);
    settings.rotation = reader.rotation("rotation").value_or(settings.rotation);
    settings.translation = reader.vector("translation", any("m")).value_or(settings.translation);
    settings.velocity = reader.vector("velocity", any("m/s")).value_or(settings.velocity);
    settings.quadrature = reader.choice<Quadrature>("quadrature", quadratures).value_or(settings.quadrature);
    read_sampling(reader, settings);
    read_kernel(reader, settings);
    for (const TableReader& region : reader.list(
             "region", {"box", "sphere", "mesh", "part", "scale", "rotation", "translation", "material", "transition"}))
        body.regions.push_back(read_region(region, materials, settings.regions.emplace_back()));
    settings.mean_dilatation = read_mean_dilatation(reader);
    settings.consistency_correction = reader.boolean("consistency").value_or(settings.consistency_correction);
    settings.friction = reader.number("friction", at_least(0)).value_or(settings.friction);
    settings.stabilization = reader.number("stabilization", between(0, 10)).value_or(settings.stabilization);

    body.place = reader.place();
    body.surface_place = reader.place(reader.has("mesh") ? "mesh" : "shape");
    body.sampling_place = sampling_place(reader);
    body.contact_place = reader.place("contact_mesh");
    return body;
}

}  // namespace

std::vector<SceneBody> read_bodies(const TableReader& root, const std::vector<SceneMaterial>& materials) {
    std::vector<SceneBody> bodies;
    Names names("body");
    for (const TableReader& reader :
         root.list("body", {"name", "mesh", "part", "shape", "contact_mesh", "contact_part", "material", "scale",
                            "rotation", "translation", "velocity", "sampling", "quadrature", "kernel", "region",
                            "mean_dilatation", "consistency", "stabilization", "friction"}))
        bodies.push_back(read_body(reader, materials, names));
    if (bodies.empty())
        root.fail(Place{}, "found no body, expected at least one; add [[body]] with a mesh or shape and a material");
    return bodies;
}

}  // namespace phyxel
