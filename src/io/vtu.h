#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>

#include "phyxel/mesh.h"
#include "phyxel/vector.h"

namespace phyxel {

/// One value, of `components` numbers, for each point of a file; the numbers lie one point after the other.
struct FieldArray {
    using Values = std::variant<std::span<const float>, std::span<const double>, std::span<const std::int32_t>,
                                std::span<const std::uint32_t>, std::span<const std::uint8_t>>;

    std::string name;
    std::size_t components = 1;
    Values values;  ///< [points * components]
};

/// Fields of vectors (3 components) and matrices (9, row by row).
FieldArray vector_field(std::string name, std::span<const Vec3> values);
FieldArray vector_field(std::string name, std::span<const Vec3f> values);
FieldArray matrix_field(std::string name, std::span<const Mat3> values);

struct VtuOptions {
    /// Level of zlib, 0 to 9; 0 stores the numbers as they are. Level 1 takes a quarter to a third off the size but
    /// some fifty times as long; higher levels gain little more.
    int compression = 0;
};

/// Writes ParaView's XML UnstructuredGrid (.vtu) with appended raw data, little endian, atomically: points with their
/// fields, one vertex cell each. A value that is not finite, and every error of the system, is an `Error`.
void write_vtu_points(const std::filesystem::path& path, std::span<const Vec3> positions,
                      std::span<const FieldArray> fields, const VtuOptions& options = {});

/// The same for a surface: triangle cells, fields at its vertices.
void write_vtu_surface(const std::filesystem::path& path, std::span<const Vec3f> positions,
                       std::span<const Triangle> triangles, std::span<const FieldArray> fields,
                       const VtuOptions& options = {});

/// One file of a ParaView collection.
struct PvdEntry {
    double time = 0;   ///< [s]
    int part = 0;      ///< tells apart the files of one time
    std::string file;  ///< relative to the collection's own folder
};

/// Writes a ParaView collection (.pvd): which file shows which time.
void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries);

}  // namespace phyxel
