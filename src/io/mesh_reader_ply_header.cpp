#include "io/mesh_reader_ply_header.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "io/mesh_reader_text.h"

namespace phyxel {

namespace {

struct TypeName {
    const char* name;
    PlyType type;
};
constexpr std::array<TypeName, 16> type_names = {{{"char", PlyType::int8},
                                                  {"int8", PlyType::int8},
                                                  {"uchar", PlyType::uint8},
                                                  {"uint8", PlyType::uint8},
                                                  {"short", PlyType::int16},
                                                  {"int16", PlyType::int16},
                                                  {"ushort", PlyType::uint16},
                                                  {"uint16", PlyType::uint16},
                                                  {"int", PlyType::int32},
                                                  {"int32", PlyType::int32},
                                                  {"uint", PlyType::uint32},
                                                  {"uint32", PlyType::uint32},
                                                  {"float", PlyType::float32},
                                                  {"float32", PlyType::float32},
                                                  {"double", PlyType::float64},
                                                  {"float64", PlyType::float64}}};

PlyType read_type(TextScanner& in) {
    const std::string_view token = in.token_on_line();
    for (const TypeName& known : type_names)
        if (token == known.name) return known.type;
    in.fail("expected a type such as float or int, but found " + in_quotes(token));
}

PlyProperty read_property(TextScanner& in) {
    PlyProperty property;
    TextScanner ahead = in;
    if (ahead.token_on_line() == "list") {
        in = ahead;
        property.count_type = read_type(in);
        if (*property.count_type == PlyType::float32 || *property.count_type == PlyType::float64)
            in.fail("a list's count cannot be a float: give it a whole type such as uchar");
    }
    property.type = read_type(in);
    property.name = in.token_on_line();
    if (property.name.empty()) in.fail("a property without a name");
    return property;
}

PlyEncoding read_encoding(TextScanner& in) {
    const std::string_view token = in.token_on_line();
    if (token == "ascii") return PlyEncoding::text;
    if (token == "binary_little_endian") return PlyEncoding::little_endian;
    if (token == "binary_big_endian") return PlyEncoding::big_endian;
    in.fail("expected format ascii, binary_little_endian or binary_big_endian, but found " + in_quotes(token));
}

PlyElement read_element(TextScanner& in) {
    PlyElement element;
    element.name = in.token_on_line();
    const std::int64_t count = in.integer_on_line("an element's count");
    if (count < 0) in.fail("an element's count is " + std::to_string(count) + ", below zero");
    element.count = static_cast<std::size_t>(count);
    return element;
}

/// Bytes that one record has at the least: a digit and a blank for each value of a text file.
std::size_t smallest_record(const PlyElement& element, PlyEncoding encoding) {
    std::size_t size = 0;
    for (const PlyProperty& property : element.properties)
        size += encoding == PlyEncoding::text ? 2 : size_of(property.count_type.value_or(property.type));
    return size;
}

void check_counts(const PlyHeader& header, const MeshFile& file) {
    const std::size_t available = file.bytes.size() - header.data_offset + 1;  // the last value needs no blank
    for (const PlyElement& element : header.elements) {
        const std::size_t record = smallest_record(element, header.encoding);
        if (record > 0 && element.count > available / record)
            file.fail("byte " + std::to_string(header.data_offset),
                      "the header announces " + std::to_string(element.count) + " records of element " +
                          in_quotes(element.name) + ", but the file has room for at most " +
                          std::to_string(available / record) + ": it is truncated or damaged, export it again");
    }
}

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::int32:
        case PlyType::uint32:
        case PlyType::float32:
            return 4;
        case PlyType::float64:
            return 8;
    }
    return 8;
}

int PlyElement::find(std::initializer_list<const char*> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        for (const char* candidate : names)
            if (properties[i].name == candidate) return static_cast<int>(i);
    return -1;
}

PlyHeader read_ply_header(const MeshFile& file) {
    TextScanner in(file);
    in.no_comments();
    if (in.token_on_line() != "ply") in.fail("does not begin with \"ply\": this is no PLY file");
    PlyHeader header;
    bool has_format = false;
    while (in.next_line()) {
        const std::string_view keyword = in.token_on_line();
        if (keyword == "format") {
            header.encoding = read_encoding(in);
            has_format = true;
        } else if (keyword == "element") {
            header.elements.push_back(read_element(in));
        } else if (keyword == "property") {
            if (header.elements.empty()) in.fail("a property before any element");
            header.elements.back().properties.push_back(read_property(in));
        } else if (keyword == "end_header") {
            if (!has_format) in.fail("the header names no format: add \"format ascii 1.0\" or the binary one it is");
            in.next_line();
            header.data_offset = file.bytes.size() - in.remaining_bytes();
            check_counts(header, file);
            return header;
        } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
            in.fail("expected element, property or end_header, but found " + in_quotes(keyword));
        }
    }
    in.fail("the file ends within its header: it is truncated, export it again");
}

}  // namespace phyxel
