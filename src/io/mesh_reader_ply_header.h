#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh_reader_formats.h"

namespace phyxel {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of one value in a binary file.
std::size_t size_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    std::optional<PlyType> count_type;  ///< of the count before a list's values; none: a single value
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;

    /// The index of the first property with one of the names, or -1.
    int find(std::initializer_list<const char*> names) const;
};

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements;  ///< in the file's order
    std::size_t data_offset = 0;       ///< first byte after the header
};

/// Reads and checks the header; the announced counts must fit into what follows.
PlyHeader read_ply_header(const MeshFile& file);

}  // namespace phyxel
