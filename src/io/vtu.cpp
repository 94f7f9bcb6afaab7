#include "io/vtu.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "io/finite_values.h"

namespace phyxel {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::uint8_t vtk_vertex = 1, vtk_triangle = 5;  // cell types of VTK

template <class T>
constexpr const char* vtk_type() {
    if constexpr (std::is_same_v<T, float>) return "Float32";
    if constexpr (std::is_same_v<T, double>) return "Float64";
    if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
    if constexpr (std::is_same_v<T, std::uint32_t>) return "UInt32";
    if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
}

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

template <class T>
void append_bytes(std::vector<std::byte>& bytes, std::span<const T> values) {
    const auto added = std::as_bytes(values);
    bytes.insert(bytes.end(), added.begin(), added.end());
}

/// One array of the appended data: UInt64 words that tell the sizes, then the data, which may lie elsewhere.
struct AppendedArray {
    std::vector<std::uint64_t> sizes;
    std::vector<std::byte> compressed;
    std::span<const std::byte> data;

    std::uint64_t size() const { return sizes.size() * sizeof(std::uint64_t) + data.size(); }
};

AppendedArray stored(std::span<const std::byte> bytes) { return {{bytes.size()}, {}, bytes}; }

/// Cuts the data into blocks and compresses each; the words are the number of blocks, the size of a block and of the
/// last one (0: a whole one), and the compressed sizes.
AppendedArray deflated(std::span<const std::byte> bytes, int level) {
    constexpr std::size_t block_size = std::size_t(1) << 18;
    AppendedArray array{{(bytes.size() + block_size - 1) / block_size, block_size, bytes.size() % block_size}, {}, {}};
    std::vector<std::byte> block(compressBound(block_size));
    while (!bytes.empty()) {
        const auto piece = bytes.first(std::min(block_size, bytes.size()));
        uLongf size = block.size();
        [[maybe_unused]] const int status =
            compress2(reinterpret_cast<Bytef*>(block.data()), &size, reinterpret_cast<const Bytef*>(piece.data()),
                      piece.size(), level);
        assert(status == Z_OK);
        array.sizes.push_back(size);
        append_bytes(array.compressed, std::span<const std::byte>(block).first(size));
        bytes = bytes.subspan(piece.size());
    }
    array.data = array.compressed;
    return array;
}

/// Collects the XML text and the arrays that it points to; `write` puts them into a file.
class VtuDocument {
public:
    VtuDocument(const std::filesystem::path& path, const VtuOptions& options) : path_(path), options_(options) {}

    void line(std::string_view text) { (xml_ += text) += '\n'; }

    template <class T>
    void array(const std::string& name, std::size_t components, std::span<const T> values) {
        require_finite(path_, name, values);
        const auto bytes = std::as_bytes(values);
        arrays_.push_back(options_.compression > 0 ? deflated(bytes, options_.compression) : stored(bytes));
        line(fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
                         vtk_type<T>(), escaped(name), components, offset_));
        offset_ += arrays_.back().size();
    }

    void write() const {
        AtomicFile file(path_);
        file.write(xml_);
        file.write("<AppendedData encoding=\"raw\">\n_");
        for (const AppendedArray& a : arrays_) {
            file.write_values(std::span(a.sizes));
            file.write(a.data);
        }
        file.write("\n</AppendedData>\n</VTKFile>\n");
        file.commit();
    }

private:
    const std::filesystem::path& path_;
    const VtuOptions& options_;
    std::string xml_;
    std::vector<AppendedArray> arrays_;
    std::uint64_t offset_ = 0;
};

/// Points, cells of one type and as many corners each, and fields at the points.
template <class T>
void write_grid(const std::filesystem::path& path, std::span<const Vec3T<T>> positions, std::uint8_t cell_type,
                std::span<const std::int32_t> corners, std::size_t corners_per_cell, std::span<const FieldArray> fields,
                const VtuOptions& options) {
    const std::size_t cells = corners.size() / corners_per_cell;
    const std::vector<std::uint8_t> types(cells, cell_type);
    std::vector<std::int32_t> ends(cells);
    for (std::size_t c = 0; c < cells; ++c) ends[c] = static_cast<std::int32_t>((c + 1) * corners_per_cell);

    VtuDocument document(path, options);
    document.line("<?xml version=\"1.0\"?>");
    document.line(fmt::format(
        R"(<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64"{}>)",
        options.compression > 0 ? R"( compressor="vtkZLibDataCompressor")" : ""));
    document.line("<UnstructuredGrid>");
    document.line(fmt::format(R"(<Piece NumberOfPoints="{}" NumberOfCells="{}">)", positions.size(), cells));

    document.line("<PointData>");
    for (const FieldArray& field : fields)
        std::visit(
            [&](auto values) {
                assert(values.size() == positions.size() * field.components);
                document.array(field.name, field.components, values);
            },
            field.values);
    document.line("</PointData>");

    document.line("<Points>");
    document.array("Points", 3, std::span(reinterpret_cast<const T*>(positions.data()), 3 * positions.size()));
    document.line("</Points>");

    document.line("<Cells>");
    document.array("connectivity", 1, corners);
    document.array("offsets", 1, std::span<const std::int32_t>(ends));
    document.array("types", 1, std::span<const std::uint8_t>(types));
    document.line("</Cells>");

    document.line("</Piece>");
    document.line("</UnstructuredGrid>");
    document.write();
}

}  // namespace

FieldArray vector_field(std::string name, std::span<const Vec3> values) {
    return {std::move(name), 3, std::span(reinterpret_cast<const double*>(values.data()), 3 * values.size())};
}

FieldArray vector_field(std::string name, std::span<const Vec3f> values) {
    return {std::move(name), 3, std::span(reinterpret_cast<const float*>(values.data()), 3 * values.size())};
}

FieldArray matrix_field(std::string name, std::span<const Mat3> values) {
    return {std::move(name), 9, std::span(reinterpret_cast<const double*>(values.data()), 9 * values.size())};
}

void write_vtu_points(const std::filesystem::path& path, std::span<const Vec3> positions,
                      std::span<const FieldArray> fields, const VtuOptions& options) {
    std::vector<std::int32_t> corners(positions.size());
    std::iota(corners.begin(), corners.end(), 0);
    write_grid(path, positions, vtk_vertex, corners, 1, fields, options);
}

void write_vtu_surface(const std::filesystem::path& path, std::span<const Vec3f> positions,
                       std::span<const Triangle> triangles, std::span<const FieldArray> fields,
                       const VtuOptions& options) {
    // VTK reads signed indices; there are never so many that the sign matters.
    const std::span corners(reinterpret_cast<const std::int32_t*>(triangles.data()), 3 * triangles.size());
    write_grid(path, positions, vtk_triangle, corners, 3, fields, options);
}

void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries) {
    std::string xml =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "<Collection>\n";
    for (const PvdEntry& entry : entries) {
        require_finite(path, "times", std::span(&entry.time, 1));
        xml += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" file=\"{}\"/>\n", entry.time, entry.part,
                           escaped(entry.file));
    }
    xml += "</Collection>\n</VTKFile>\n";
    write_file(path, xml);
}

}  // namespace phyxel
