#include "base/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace phyxel {
namespace {

constexpr std::uint64_t seed = 2654435761;

/// The input of the reference implementation's self-check (xxhsum).
std::vector<std::byte> reference_input(std::size_t size) {
    std::vector<std::byte> bytes(size);
    std::uint64_t generator = seed;
    for (std::byte& b : bytes) {
        b = static_cast<std::byte>(generator >> 56);
        generator *= 11400714785074694797ULL;
    }
    return bytes;
}

TEST(Hash, gives_the_published_values) {
    struct Row {
        std::size_t size;
        std::uint64_t seed, expected;
    };
    for (const Row& row :
         {Row{0, 0, 0xEF46DB3751D8E999}, Row{0, seed, 0xAC75FDA2929B17EF}, Row{1, 0, 0xE934A84ADB052768},
          Row{1, seed, 0x5014607643A9B4C3}, Row{4, 0, 0x9136A0DCA57457EE}, Row{14, 0, 0x8282DCC4994E35C8},
          Row{14, seed, 0xC3BD6BF63DEB6DF0}, Row{222, 0, 0xB641AE8CB691C174}, Row{222, seed, 0x20CB8AB7AE10C14A}})
        EXPECT_EQ(hash64(reference_input(row.size), row.seed), row.expected) << row.size << " bytes, seed " << row.seed;
}

TEST(Hash, does_not_depend_on_the_pieces_the_bytes_come_in) {
    const std::vector<std::byte> bytes = reference_input(300);
    const std::uint64_t expected = hash64(bytes);
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
        Hasher hasher;
        for (std::size_t i = 0; i < bytes.size(); i += piece)
            hasher.add(std::span(bytes).subspan(i, std::min(piece, bytes.size() - i)));
        EXPECT_EQ(hasher.value(), expected) << "in pieces of " << piece;
    }
}

TEST(Hash, tells_apart_every_flipped_bit) {
    std::vector<std::byte> bytes = reference_input(100);
    const std::uint64_t expected = hash64(bytes);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] ^= std::byte(1 << bit % 8);
        EXPECT_NE(hash64(bytes), expected) << "bit " << bit;
        bytes[bit / 8] ^= std::byte(1 << bit % 8);
    }
}

}  // namespace
}  // namespace phyxel
