#include <bit>
#include <memory>
#include <optional>

#include "io/mesh_reader_ply_header.h"
#include "io/mesh_reader_text.h"

/// Stanford PLY, text and binary of either byte order, with any properties in any order. Read are x, y, z of element
/// `vertex`, the list `vertex_indices` (or `vertex_index`) of element `face`, and `tristrips`; all else is skipped.

namespace phyxel {

namespace {

/// Reads values one after the other.
class PlySource {
public:
    virtual ~PlySource() = default;
    virtual double read(PlyType type, const char* what) = 0;
    virtual void skip(PlyType type, std::size_t count) = 0;
    virtual std::size_t place() const = 0;  ///< line or byte
    virtual std::size_t remaining_bytes() const = 0;
    virtual std::size_t smallest_value(PlyType type) const = 0;  ///< bytes
    [[noreturn]] virtual void fail(const std::string& message) const = 0;
};

class PlyText final : public PlySource {
public:
    PlyText(const MeshFile& file, std::size_t offset) : in_(file, offset) { in_.no_comments(); }

    double read(PlyType, const char* what) override { return in_.to_number(next(what), what); }
    void skip(PlyType, std::size_t count) override {
        for (std::size_t i = 0; i < count; ++i) next("a value");
    }
    std::size_t place() const override { return in_.line(); }
    std::size_t remaining_bytes() const override { return in_.remaining_bytes(); }
    std::size_t smallest_value(PlyType) const override { return 2; }
    void fail(const std::string& message) const override { in_.fail(message); }

private:
    std::string_view next(const char* what) {
        const std::string_view token = in_.token();
        if (token.empty())
            in_.fail(std::string("the file ends where ") + what + " should stand: it is truncated, export it again");
        return token;
    }

    TextScanner in_;
};

class PlyBinary final : public PlySource {
public:
    PlyBinary(const MeshFile& file, std::size_t offset, bool big_endian)
        : file_(file), at_(offset), big_endian_(big_endian) {}

    double read(PlyType type, const char* what) override {
        if (size_of(type) > remaining_bytes())
            fail(std::string("the file ends where ") + what + " should stand: it is truncated, export it again");
        const double value = decode(type);
        if (!std::isfinite(value))
            fail(std::string(what) + " is not a finite number: mend it in the program that wrote the file");
        at_ += size_of(type);
        return value;
    }
    void skip(PlyType type, std::size_t count) override {
        if (count > remaining_bytes() / size_of(type))
            fail("the file ends within a list or record: it is truncated, export it again");
        at_ += count * size_of(type);
    }
    std::size_t place() const override { return at_; }
    std::size_t remaining_bytes() const override { return file_.bytes.size() - at_; }
    std::size_t smallest_value(PlyType type) const override { return size_of(type); }
    void fail(const std::string& message) const override { file_.fail("byte " + std::to_string(at_), message); }

private:
    double decode(PlyType type) const {
        std::uint64_t bits = 0;
        const std::size_t size = size_of(type);
        for (std::size_t k = 0; k < size; ++k)
            bits = bits << 8 | static_cast<unsigned char>(file_.bytes[at_ + (big_endian_ ? k : size - 1 - k)]);
        switch (type) {
            case PlyType::int8:
                return static_cast<std::int8_t>(bits);
            case PlyType::int16:
                return static_cast<std::int16_t>(bits);
            case PlyType::int32:
                return static_cast<std::int32_t>(bits);
            case PlyType::uint8:
            case PlyType::uint16:
            case PlyType::uint32:
                return static_cast<double>(bits);
            case PlyType::float32:
                return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
            case PlyType::float64:
                return std::bit_cast<double>(bits);
        }
        return 0;
    }

    const MeshFile& file_;
    std::size_t at_;
    bool big_endian_;
};

std::int64_t read_integer(PlySource& in, PlyType type, const char* what) {
    const double value = in.read(type, what);
    if (value != std::floor(value) || std::abs(value) > 1e15)
        in.fail(std::string("expected ") + what + ", a whole number, but found " + std::to_string(value));
    return static_cast<std::int64_t>(value);
}

/// The number of values of a list, which the rest of the file must be able to hold.
std::size_t read_list_size(PlySource& in, const PlyProperty& property) {
    const std::int64_t count = read_integer(in, *property.count_type, "a list's length");
    if (count < 0 || static_cast<std::uint64_t>(count) > (in.remaining_bytes() + 1) / in.smallest_value(property.type))
        in.fail("a list of " + std::to_string(count) +
                " values does not fit into the file: it is truncated or damaged, export it again");
    return static_cast<std::size_t>(count);
}

void skip(PlySource& in, const PlyProperty& property) {
    in.skip(property.type, property.count_type ? read_list_size(in, property) : 1);
}

void read_vertices(PlySource& in, const PlyElement& element, PolygonMesh& mesh) {
    const std::array<int, 3> xyz = {element.find({"x"}), element.find({"y"}), element.find({"z"})};
    for (const int property : xyz)
        if (property < 0 || element.properties[static_cast<std::size_t>(property)].count_type)
            in.fail("element \"vertex\" needs the single values x, y and z: export the mesh with positions");
    mesh.vertices.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
        Vec3 x;
        for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
            const PlyProperty& property = element.properties[static_cast<std::size_t>(p)];
            if (p == xyz[0]) x.x = in.read(property.type, "a vertex's x");
            else if (p == xyz[1]) x.y = in.read(property.type, "a vertex's y");
            else if (p == xyz[2]) x.z = in.read(property.type, "a vertex's z");
            else skip(in, property);
        }
        mesh.vertices.push_back(x);
    }
}

void read_polygon(PlySource& in, const PlyProperty& property, PolygonMesh& mesh) {
    const std::size_t place = in.place(), count = read_list_size(in, property);
    for (std::size_t k = 0; k < count; ++k) mesh.corners.push_back(read_integer(in, property.type, "a face's vertex"));
    mesh.end_polygon(place);
}

/// Each index after the second makes a triangle with the two before it, every other one turned; -1 begins a new strip.
void read_strips(PlySource& in, const PlyProperty& property, PolygonMesh& mesh) {
    const std::size_t place = in.place(), count = read_list_size(in, property);
    std::vector<std::int64_t> strip;
    for (std::size_t k = 0; k < count; ++k) {
        const std::int64_t index = read_integer(in, property.type, "a strip's vertex");
        if (index == -1) {
            strip.clear();
            continue;
        }
        strip.push_back(index);
        const std::size_t n = strip.size();
        if (n < 3) continue;
        const bool turned = n % 2 == 0;
        mesh.corners.insert(mesh.corners.end(),
                            {strip[n - (turned ? 2 : 3)], strip[n - (turned ? 3 : 2)], strip[n - 1]});
        mesh.end_polygon(place);
    }
}

/// Reads the list property `wanted` of every record by `read_list`, and skips all others.
template <class ReadList>
void read_lists(PlySource& in, const PlyElement& element, int wanted, ReadList&& read_list) {
    if (wanted < 0 || !element.properties[static_cast<std::size_t>(wanted)].count_type)
        in.fail("element " + in_quotes(element.name) + " needs the list vertex_indices: export the mesh with faces");
    for (std::size_t i = 0; i < element.count; ++i)
        for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
            const PlyProperty& property = element.properties[static_cast<std::size_t>(p)];
            if (p == wanted) read_list(property);
            else skip(in, property);
        }
}

}  // namespace

PolygonMesh read_ply(const MeshFile& file) {
    const PlyHeader header = read_ply_header(file);
    std::unique_ptr<PlySource> in;
    if (header.encoding == PlyEncoding::text) in = std::make_unique<PlyText>(file, header.data_offset);
    else in = std::make_unique<PlyBinary>(file, header.data_offset, header.encoding == PlyEncoding::big_endian);

    PolygonMesh mesh;
    mesh.place_unit = header.encoding == PlyEncoding::text ? "line" : "byte";
    for (const PlyElement& element : header.elements) {
        const int indices = element.find({"vertex_indices", "vertex_index"});
        if (element.name == "vertex") {
            read_vertices(*in, element, mesh);
        } else if (element.name == "face") {
            read_lists(*in, element, indices, [&](const PlyProperty& p) { read_polygon(*in, p, mesh); });
        } else if (element.name == "tristrips") {
            read_lists(*in, element, indices, [&](const PlyProperty& p) { read_strips(*in, p, mesh); });
        } else if (!element.properties.empty()) {
            for (std::size_t i = 0; i < element.count; ++i)
                for (const PlyProperty& property : element.properties) skip(*in, property);
        }
    }
    return mesh;
}

}  // namespace phyxel
