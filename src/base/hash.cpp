#include "base/hash.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace phyxel {
namespace {

static_assert(std::endian::native == std::endian::little, "words are read in little-endian order");

// The primes of the specification.
constexpr std::uint64_t prime1 = 0x9E3779B185EBCA87, prime2 = 0xC2B2AE3D27D4EB4F, prime3 = 0x165667B19E3779F9,
                        prime4 = 0x85EBCA77C2B2AE63, prime5 = 0x27D4EB2F165667C5;

template <class Word>
Word read(const std::byte* bytes) {
    Word word;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

std::uint64_t mixed(std::uint64_t lane, std::uint64_t word) { return std::rotl(lane + word * prime2, 31) * prime1; }

}  // namespace

Hasher::Hasher(std::uint64_t seed) : seed_(seed), lanes_{seed + prime1 + prime2, seed + prime2, seed, seed - prime1} {}

void Hasher::add(std::span<const std::byte> bytes) {
    length_ += bytes.size();

    // Fill up what is left of the last piece.
    if (pending_size_ > 0) {
        const std::size_t taken = std::min(stripe - pending_size_, bytes.size());
        std::copy_n(bytes.begin(), taken, pending_.begin() + static_cast<std::ptrdiff_t>(pending_size_));
        pending_size_ += taken;
        bytes = bytes.subspan(taken);
        if (pending_size_ < stripe) return;
        consume(pending_.data());
        pending_size_ = 0;
    }

    // Whole stripes, then the rest for later.
    for (; bytes.size() >= stripe; bytes = bytes.subspan(stripe)) consume(bytes.data());
    std::copy(bytes.begin(), bytes.end(), pending_.begin());
    pending_size_ = bytes.size();
}

void Hasher::consume(const std::byte* bytes) {
    for (std::size_t i = 0; i < lanes_.size(); ++i) lanes_[i] = mixed(lanes_[i], read<std::uint64_t>(bytes + 8 * i));
}

std::uint64_t Hasher::value() const {
    // The lanes become one word; short input never reached them.
    std::uint64_t h = seed_ + prime5;
    if (length_ >= stripe) {
        h = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) + std::rotl(lanes_[3], 18);
        for (const std::uint64_t lane : lanes_) h = (h ^ mixed(0, lane)) * prime1 + prime4;
    }
    h += length_;

    // What is left: by eight, four and one.
    const std::byte* p = pending_.data();
    const std::byte* const end = p + pending_size_;
    for (; end - p >= 8; p += 8) h = std::rotl(h ^ mixed(0, read<std::uint64_t>(p)), 27) * prime1 + prime4;
    for (; end - p >= 4; p += 4) h = std::rotl(h ^ (read<std::uint32_t>(p) * prime1), 23) * prime2 + prime3;
    for (; p < end; ++p) h = std::rotl(h ^ (std::to_integer<std::uint64_t>(*p) * prime5), 11) * prime1;

    // Avalanche: every bit of the input reaches every bit of the result.
    h = (h ^ (h >> 33)) * prime2;
    h = (h ^ (h >> 29)) * prime3;
    return h ^ (h >> 32);
}

std::uint64_t hash64(std::span<const std::byte> bytes, std::uint64_t seed) {
    Hasher hasher(seed);
    hasher.add(bytes);
    return hasher.value();
}

}  // namespace phyxel
