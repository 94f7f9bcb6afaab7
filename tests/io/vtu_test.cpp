#include "io/vtu.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "io/tetrahedron.h"
#include "phyxel/error.h"
#include "support/file_bytes.h"
#include "support/little_xml.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::LittleXml;
using test::read_bytes;
using test::TemporaryDirectory;
using test::XmlElement;

/// A reader of VTU files that shares nothing with the writer.
class VtuReader {
public:
    explicit VtuReader(const std::filesystem::path& path) : bytes_(read_bytes(path)) {
        LittleXml xml(bytes_);
        root_ = xml.parse();
        if (bytes_.at(xml.position()) != '_') throw std::runtime_error("no _ before the appended data");
        data_ = xml.position() + 1;
        compressed_ = root_.attributes.count("compressor") > 0;
    }

    const XmlElement& piece() const { return root_.child("UnstructuredGrid").child("Piece"); }
    const std::string& attribute(const std::string& name) const { return root_.attributes.at(name); }

    const XmlElement& array(const std::string& group, const std::string& name) const {
        for (const XmlElement& a : piece().child(group).children)
            if (a.attributes.at("Name") == name) return a;
        throw std::runtime_error("no array " + name);
    }

    template <class T>
    std::vector<T> values(const std::string& group, const std::string& name) const {
        const std::string bytes = content(std::stoull(array(group, name).attributes.at("offset")));
        std::vector<T> result(bytes.size() / sizeof(T));
        if (!result.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
        return result;
    }

    /// Where the last array ends, to see that nothing is lost behind it.
    std::string behind(const std::string& group, const std::string& name) const {
        content(std::stoull(array(group, name).attributes.at("offset")));
        return bytes_.substr(end_);
    }

private:
    std::uint64_t word(std::size_t at) const {
        std::uint64_t value;
        std::memcpy(&value, bytes_.substr(at, 8).data(), 8);
        return value;
    }

    std::string content(std::size_t offset) const {
        std::size_t at = data_ + offset;
        if (!compressed_) {
            end_ = at + 8 + word(at);
            return bytes_.substr(at + 8, word(at));
        }
        const std::uint64_t blocks = word(at), size = word(at + 8), last = word(at + 16);
        std::size_t from = at + 24 + 8 * blocks;
        std::string result;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            std::string block(b + 1 == blocks && last > 0 ? last : size, '\0');
            uLongf length = block.size();
            const std::uint64_t packed = word(at + 24 + 8 * b);
            if (uncompress(reinterpret_cast<Bytef*>(block.data()), &length,
                           reinterpret_cast<const Bytef*>(bytes_.data() + from), packed) != Z_OK ||
                length != block.size())
                throw std::runtime_error("damaged block");
            result += block;
            from += packed;
        }
        end_ = from;
        return result;
    }

    std::string bytes_;
    XmlElement root_;
    std::size_t data_ = 0;
    mutable std::size_t end_ = 0;
    bool compressed_ = false;
};

class Vtu : public testing::TestWithParam<int> {
protected:
    VtuOptions options() const { return {.compression = GetParam()}; }
    TemporaryDirectory folder_;
};

TEST_P(Vtu, of_points_gives_back_every_bit) {
    const std::size_t n = 40000;  // several blocks
    std::vector<Vec3> positions(n);
    std::vector<Mat3> gradients(n);
    std::vector<float> stress(n);
    std::vector<std::int32_t> labels(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double t = 0.001 * static_cast<double>(i);
        positions[i] = {std::cos(t), std::sin(t), t};
        gradients[i] = outer(positions[i], Vec3{1, t, -t});
        stress[i] = static_cast<float>(t * t);
        labels[i] = -static_cast<std::int32_t>(i);
    }
    const FieldArray fields[] = {vector_field("velocity", positions),
                                 matrix_field("F", gradients),
                                 {"von_Mises", 1, std::span<const float>(stress)},
                                 {"label <&\">", 1, std::span<const std::int32_t>(labels)}};
    write_vtu_points(folder_ / "a.vtu", positions, fields, options());

    const VtuReader file(folder_ / "a.vtu");
    EXPECT_EQ(file.attribute("byte_order"), "LittleEndian");
    EXPECT_EQ(file.attribute("header_type"), "UInt64");
    EXPECT_EQ(file.piece().attributes.at("NumberOfPoints"), "40000");
    EXPECT_EQ(file.piece().attributes.at("NumberOfCells"), "40000");
    EXPECT_EQ(file.array("PointData", "F").attributes.at("NumberOfComponents"), "9");
    EXPECT_EQ(file.array("PointData", "F").attributes.at("type"), "Float64");
    EXPECT_EQ(file.array("PointData", "von_Mises").attributes.at("type"), "Float32");
    EXPECT_EQ(file.values<Vec3>("Points", "Points"), positions);
    EXPECT_EQ(file.values<Vec3>("PointData", "velocity"), positions);
    EXPECT_EQ(file.values<Mat3>("PointData", "F"), gradients);
    EXPECT_EQ(file.values<float>("PointData", "von_Mises"), stress);
    EXPECT_EQ(file.values<std::int32_t>("PointData", "label <&\">"), labels);

    std::vector<std::int32_t> counting(n);
    std::iota(counting.begin(), counting.end(), 0);
    EXPECT_EQ(file.values<std::int32_t>("Cells", "connectivity"), counting);
    std::iota(counting.begin(), counting.end(), 1);
    EXPECT_EQ(file.values<std::int32_t>("Cells", "offsets"), counting);
    EXPECT_EQ(file.values<std::uint8_t>("Cells", "types"), std::vector<std::uint8_t>(n, 1));
    EXPECT_EQ(file.behind("Cells", "types"), "\n</AppendedData>\n</VTKFile>\n");
}

TEST_P(Vtu, of_a_surface_gives_back_its_triangles) {
    const FieldArray fields[] = {vector_field("normal", tetrahedron)};
    write_vtu_surface(folder_ / "a.vtu", tetrahedron, tetrahedron_faces, fields, options());

    const VtuReader file(folder_ / "a.vtu");
    EXPECT_EQ(file.piece().attributes.at("NumberOfPoints"), "4");
    EXPECT_EQ(file.array("Points", "Points").attributes.at("type"), "Float32");
    EXPECT_EQ(file.values<Vec3f>("Points", "Points"), tetrahedron);
    EXPECT_EQ(file.values<Vec3f>("PointData", "normal"), tetrahedron);
    EXPECT_EQ(file.values<Triangle>("Cells", "connectivity"), tetrahedron_faces);
    EXPECT_EQ(file.values<std::int32_t>("Cells", "offsets"), (std::vector<std::int32_t>{3, 6, 9, 12}));
    EXPECT_EQ(file.values<std::uint8_t>("Cells", "types"), std::vector<std::uint8_t>(4, 5));
}

TEST_P(Vtu, of_no_points_is_a_whole_file) {
    write_vtu_points(folder_ / "a.vtu", {}, {}, options());
    const VtuReader file(folder_ / "a.vtu");
    EXPECT_TRUE(file.values<double>("Points", "Points").empty());
    EXPECT_EQ(file.behind("Cells", "types"), "\n</AppendedData>\n</VTKFile>\n");
}

TEST_P(Vtu, never_holds_a_value_that_is_not_finite) {
    const std::vector<Vec3> positions = {{1, 2, 3}, {4, 5, 6}};
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        const std::vector<double> values = {1, bad};
        const FieldArray fields[] = {{"pressure", 1, std::span<const double>(values)}};
        const std::vector<Vec3> lost = {{1, 2, 3}, {4, bad, 6}};
        EXPECT_THROW(write_vtu_points(folder_ / "a.vtu", positions, fields, options()), Error);
        EXPECT_THROW(write_vtu_points(folder_ / "a.vtu", lost, {}, options()), Error);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

INSTANTIATE_TEST_SUITE_P(Compression, Vtu, testing::Values(0, 1, 6));

TEST(Vtu, is_smaller_when_compressed) {
    const TemporaryDirectory folder;
    const std::vector<Vec3> positions(10000, Vec3{1, 2, 3});
    write_vtu_points(folder / "raw.vtu", positions, {});
    write_vtu_points(folder / "packed.vtu", positions, {}, {.compression = 1});
    EXPECT_LT(std::filesystem::file_size(folder / "packed.vtu") * 5, std::filesystem::file_size(folder / "raw.vtu"));
}

TEST(Vtu, names_what_is_not_finite) {
    const TemporaryDirectory folder;
    const std::vector<Vec3> positions = {{1, 2, 3}};
    const std::vector<float> values = {std::nanf("")};
    const FieldArray fields[] = {{"pressure", 1, std::span<const float>(values)}};
    try {
        write_vtu_points(folder / "a.vtu", positions, fields);
        FAIL() << "was written";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("number 0 of its pressure is not finite"), std::string::npos)
            << error.what();
    }
}

TEST(Pvd, lists_times_parts_and_files) {
    const TemporaryDirectory folder;
    const PvdEntry entries[] = {{0, 0, "nodes_0000.vtu"}, {1.0 / 60, 1, "a & b.vtu"}};
    write_pvd(folder / "a.pvd", entries);
    const std::string text = read_bytes(folder / "a.pvd");
    const XmlElement root = LittleXml(text).parse();
    EXPECT_EQ(root.attributes.at("type"), "Collection");
    const auto& sets = root.child("Collection").children;
    ASSERT_EQ(sets.size(), 2u);
    EXPECT_EQ(sets[0].attributes.at("file"), "nodes_0000.vtu");
    EXPECT_EQ(std::stod(sets[1].attributes.at("timestep")), 1.0 / 60);
    EXPECT_EQ(sets[1].attributes.at("part"), "1");
    EXPECT_EQ(sets[1].attributes.at("file"), "a & b.vtu");
}

TEST(Pvd, never_holds_a_time_that_is_not_finite) {
    const TemporaryDirectory folder;
    const PvdEntry entries[] = {{std::nan(""), 0, "a.vtu"}};
    EXPECT_THROW(write_pvd(folder / "a.pvd", entries), Error);
}

}  // namespace
}  // namespace phyxel
