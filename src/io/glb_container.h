#pragma once

#include <cstdint>

/// The words of glTF's binary container (glTF 2.0 specification, section 4): a header of magic, version and length of
/// the file; then chunks, each of length, kind and bytes.

namespace phyxel::glb {

inline constexpr std::uint32_t magic = 0x46546C67, version = 2;
inline constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

}  // namespace phyxel::glb
