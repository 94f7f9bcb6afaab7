#include "io/mesh_reader_gltf_check.h"

#include <nlohmann/json.hpp>
#include <system_error>

#include "io/glb_container.h"

namespace phyxel {

namespace {

using Json = nlohmann::json;

/// The JSON text of the file, and its binary chunk.
struct Chunks {
    std::string_view json, binary;
};

Chunks split_glb(const MeshFile& file) {
    const std::string& bytes = file.bytes;
    const auto require = [&](bool holds, std::size_t at, const char* message) {
        if (!holds)
            file.fail("byte " + std::to_string(at),
                      std::string(message) + ": the file is truncated or damaged, export it again");
    };
    require(bytes.size() >= 20, bytes.size(), "the file ends within the GLB header");
    require(u32_at(bytes, 4) == 2, 4, "expected GLB version 2");
    const std::size_t length = u32_at(bytes, 8);
    require(length <= bytes.size(), 8, "the GLB header announces more bytes than the file has");
    const std::size_t json_length = u32_at(bytes, 12);
    require(length >= 20 && json_length <= length - 20, 12, "the JSON chunk is longer than the file");
    require(u32_at(bytes, 16) == glb::json_chunk, 16, "expected a JSON chunk");
    Chunks chunks{.json = std::string_view(bytes).substr(20, json_length), .binary = {}};
    const std::size_t next = 20 + (json_length + 3) / 4 * 4;
    if (next + 8 <= length) {
        require(u32_at(bytes, next) <= length - next - 8, next, "the binary chunk is longer than the file");
        if (u32_at(bytes, next + 4) == glb::binary_chunk)
            chunks.binary = std::string_view(bytes).substr(next + 8, u32_at(bytes, next));
    }
    return chunks;
}

/// The checks on the JSON tree. nlohmann's exceptions for a wrong type or a missing key become errors in `check_gltf`.
class Checker {
public:
    Checker(const MeshFile& file, const Json& root, std::string_view binary)
        : file_(file), root_(root), binary_(binary) {}

    void check() {
        for (std::size_t i = 0; i < list("buffers").size(); ++i) check_buffer(i);
        for (std::size_t i = 0; i < list("bufferViews").size(); ++i) check_view(i);
        for (std::size_t i = 0; i < list("accessors").size(); ++i) check_accessor(i);
        for (std::size_t i = 0; i < list("meshes").size(); ++i) check_mesh(i);
        check_nodes();
    }

private:
    const Json& list(const char* key) const {
        static const Json none = Json::array();
        const auto entry = root_.find(key);
        if (entry == root_.end()) return none;
        if (!entry->is_array()) file_.fail(key, "expected a list");
        return *entry;
    }

    std::size_t number(const Json& object, const char* key, const std::string& place) const {
        const auto entry = object.find(key);
        if (entry == object.end()) return 0;
        if (!entry->is_number_unsigned() || entry->get<std::uint64_t>() > (std::uint64_t{1} << 40))
            file_.fail(place + "." + key, "expected a whole number, but found " + in_quotes(entry->dump()));
        return entry->get<std::size_t>();
    }

    /// An index into the list `of`.
    std::size_t reference(const Json& value, const char* of, const std::string& place) const {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= list(of).size())
            file_.fail(place, "names entry " + in_quotes(value.dump()) + " of " + of + ", which has " +
                                  std::to_string(list(of).size()) + " entries: the file is damaged, export it again");
        return value.get<std::size_t>();
    }

    void require(bool holds, const std::string& place, const std::string& message) const {
        if (!holds) file_.fail(place, message + ": the file is truncated or damaged, export it again");
    }

    static std::string at(const char* key, std::size_t i) { return std::string(key) + "[" + std::to_string(i) + "]"; }

    void check_buffer(std::size_t i) const {
        const Json& buffer = list("buffers")[i];
        const std::string place = at("buffers", i);
        const std::size_t length = number(buffer, "byteLength", place);
        if (!buffer.contains("uri")) {
            require(i == 0 && length <= binary_.size(), place,
                    "announces " + std::to_string(length) + " bytes, but the file's binary chunk has " +
                        std::to_string(binary_.size()));
            return;
        }
        const std::string uri = buffer.at("uri").get<std::string>();
        if (uri.starts_with("data:")) {
            const std::size_t comma = uri.find(";base64,");
            require(comma != uri.npos, place, "holds data that is not base64");
            const std::string_view data = std::string_view(uri).substr(comma + 8);
            const std::size_t padding = data.size() - std::min(data.size(), data.find_last_not_of('=') + 1);
            require(data.size() % 4 == 0 && padding <= 2 &&
                        data.substr(0, data.size() - padding)
                                .find_first_not_of(
                                    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/") == data.npos,
                    place, "holds damaged base64 data");
            require(length <= data.size() / 4 * 3 - padding, place,
                    "announces " + std::to_string(length) + " bytes, more than its data holds");
            return;
        }
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(file_.path.parent_path() / uri, error);
        if (error)
            file_.fail(place,
                       "the file " + in_quotes(uri) + " beside it cannot be read: copy it there, or export as .glb");
        require(
            length <= size, place,
            "announces " + std::to_string(length) + " bytes, but " + in_quotes(uri) + " has " + std::to_string(size));
    }

    void check_view(std::size_t i) const {
        const Json& view = list("bufferViews")[i];
        const std::string place = at("bufferViews", i);
        const std::size_t buffer = reference(view.at("buffer"), "buffers", place);
        const std::size_t end = number(view, "byteOffset", place) + number(view, "byteLength", place);
        require(end <= number(list("buffers")[buffer], "byteLength", place), place, "reaches beyond its buffer");
    }

    void check_accessor(std::size_t i) const {
        const Json& accessor = list("accessors")[i];
        const std::string place = at("accessors", i);
        const std::size_t size = component_size(number(accessor, "componentType", place)) *
                                 components(accessor.at("type").get<std::string>());
        require(size > 0, place, "has an unknown type");
        const std::size_t count = number(accessor, "count", place);
        if (accessor.contains("sparse"))
            file_.fail(place, "is sparse, which cannot be read: export the mesh without sparse accessors");
        if (!accessor.contains("bufferView") || count == 0) return;  // Draco keeps its data elsewhere
        const Json& view = list("bufferViews")[reference(accessor.at("bufferView"), "bufferViews", place)];
        const std::size_t stride = std::max(size, number(view, "byteStride", place));
        require(
            number(accessor, "byteOffset", place) + stride * (count - 1) + size <= number(view, "byteLength", place),
            place, "reaches beyond its buffer view");
    }

    void check_mesh(std::size_t i) const {
        for (const Json& primitive : list("meshes")[i].at("primitives")) {
            const std::string place = at("meshes", i);
            const bool compressed =
                primitive.contains("extensions") && primitive.at("extensions").contains("KHR_draco_mesh_compression");
            if (primitive.contains("indices")) reference(primitive.at("indices"), "accessors", place + ".indices");
            for (const auto& [name, value] : primitive.at("attributes").items())
                reference(value, "accessors", place + "." + name);
            if (!primitive.at("attributes").contains("POSITION")) continue;
            const Json& positions = list("accessors")[primitive.at("attributes").at("POSITION").get<std::size_t>()];
            if (number(positions, "componentType", place) != 5126 || positions.at("type") != "VEC3")
                file_.fail(place + ".POSITION",
                           "positions are not three floats each: export the mesh without quantization");
            if (!compressed && !positions.contains("bufferView"))
                file_.fail(place + ".POSITION", "positions have no data: export the mesh again");
            if (!compressed && primitive.contains("indices"))
                check_indices(list("accessors")[primitive.at("indices").get<std::size_t>()],
                              number(positions, "count", place), place + ".indices");
        }
    }

    /// Indices in the file's own binary chunk must name vertices: assimp leaves out the triangles of those that do not.
    void check_indices(const Json& accessor, std::size_t vertices, const std::string& place) const {
        if (!accessor.contains("bufferView")) return;
        const Json& view = list("bufferViews")[accessor.at("bufferView").get<std::size_t>()];
        if (list("buffers")[view.at("buffer").get<std::size_t>()].contains("uri")) return;
        const std::size_t size = component_size(number(accessor, "componentType", place));
        const std::size_t stride = std::max(size, number(view, "byteStride", place));
        const std::size_t first = number(view, "byteOffset", place) + number(accessor, "byteOffset", place);
        for (std::size_t i = 0; i < number(accessor, "count", place); ++i) {
            std::size_t index = 0;
            for (std::size_t k = size; k-- > 0;)
                index = index << 8 | static_cast<unsigned char>(binary_[first + i * stride + k]);
            require(index < vertices, place,
                    "a triangle uses vertex " + std::to_string(index) + " of " + std::to_string(vertices));
        }
    }

    /// Every node has at most one parent and no chain of parents comes back: else the tree would have no end.
    void check_nodes() const {
        const Json& nodes = list("nodes");
        std::vector<std::size_t> parent(nodes.size(), nodes.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const std::string place = at("nodes", i);
            if (nodes[i].contains("mesh")) reference(nodes[i].at("mesh"), "meshes", place + ".mesh");
            if (!nodes[i].contains("children")) continue;
            for (const Json& entry : nodes[i].at("children")) {
                const std::size_t child = reference(entry, "nodes", place + ".children");
                require(parent[child] == nodes.size(), place, "node " + std::to_string(child) + " has two parents");
                parent[child] = i;
            }
        }
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            std::size_t depth = 0;
            for (std::size_t n = i; n < nodes.size(); n = parent[n])
                require(++depth <= deepest_tree, at("nodes", i), "is its own ancestor, or lies too deep");
        }
        for (std::size_t s = 0; s < list("scenes").size(); ++s)
            if (list("scenes")[s].contains("nodes"))
                for (const Json& entry : list("scenes")[s].at("nodes")) reference(entry, "nodes", at("scenes", s));
    }

    static std::size_t component_size(std::size_t type) {
        return type == 5120 || type == 5121   ? 1
               : type == 5122 || type == 5123 ? 2
               : type == 5125 || type == 5126 ? 4
                                              : 0;
    }
    static std::size_t components(const std::string& type) {
        if (type == "SCALAR") return 1;
        if (type.starts_with("VEC") && type.size() == 4) return static_cast<std::size_t>(type[3] - '0');
        return type == "MAT2" ? 4 : type == "MAT3" ? 9 : type == "MAT4" ? 16 : 0;
    }

    static constexpr std::size_t deepest_tree = 1000;  // assimp follows it by recursion

    const MeshFile& file_;
    const Json& root_;
    std::string_view binary_;
};

}  // namespace

void check_gltf(const MeshFile& file) {
    const bool binary = file.bytes.size() >= 4 && u32_at(file.bytes, 0) == glb::magic;
    const Chunks chunks = binary ? split_glb(file) : Chunks{.json = file.bytes, .binary = {}};
    try {
        const Json root = Json::parse(chunks.json);
        if (!root.is_object() || !root.contains("asset")) file.fail("", "holds no glTF: it has no entry \"asset\"");
        Checker(file, root, chunks.binary).check();
    } catch (const Json::parse_error& error) {
        file.fail("byte " + std::to_string(error.byte + (binary ? 20 : 0)), "is no glTF: " + std::string(error.what()));
    } catch (const Json::exception& error) {
        file.fail("", "is no valid glTF: " + std::string(error.what()));
    }
}

}  // namespace phyxel
