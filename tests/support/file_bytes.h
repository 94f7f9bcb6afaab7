#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace phyxel::test {

/// All bytes of a file; empty when there is none.
inline std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace phyxel::test
