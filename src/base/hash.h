#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace phyxel {

/// 64-bit hash of a sequence of bytes: XXH64 of Yann Collet's "xxHash fast digest algorithm" (version 0.1.1). Not
/// cryptographic: it tells apart what differs by accident. Bytes may come in any pieces; only their sequence counts.
class Hasher {
public:
    explicit Hasher(std::uint64_t seed = 0);

    void add(std::span<const std::byte> bytes);

    /// The values' own bytes; a type with padding must not be given.
    template <class T>
    void add_values(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        add(std::as_bytes(values));
    }
    template <class T>
    void add_value(const T& value) {
        add_values(std::span<const T>(&value, 1));
    }

    /// Hash of all bytes so far.
    std::uint64_t value() const;

private:
    static constexpr std::size_t stripe = 32;  // bytes that the four lanes take at a time

    void consume(const std::byte* bytes);

    std::uint64_t seed_;
    std::array<std::uint64_t, 4> lanes_;
    std::array<std::byte, stripe> pending_{};
    std::size_t pending_size_ = 0;
    std::uint64_t length_ = 0;
};

/// Hash of `bytes` alone.
std::uint64_t hash64(std::span<const std::byte> bytes, std::uint64_t seed = 0);

}  // namespace phyxel
