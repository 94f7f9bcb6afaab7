#include "world/checkpoint_file.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <optional>
#include <system_error>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "phyxel/error.h"
#include "phyxel/version.h"

namespace phyxel {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints hold the machine's own bytes");

constexpr std::string_view magic = "PHYXELCP";
constexpr std::uint32_t byte_order = 0x01020304, other_byte_order = 0x04030201;

/// The part of the file that is read before anything is allocated.
struct Header {
    char magic[8];
    std::uint32_t format, byte_order;
    std::uint64_t file_size;
};
static_assert(sizeof(Header) == 24);

constexpr std::size_t hash_size = sizeof(std::uint64_t);

/// Takes values off the front of what is left; nothing is taken that is not there.
class Cursor {
public:
    explicit Cursor(std::span<const std::byte> bytes) : left_(bytes) {}

    bool at_end() const { return left_.empty(); }

    std::optional<std::span<const std::byte>> take(std::uint64_t count) {
        if (count > left_.size()) return std::nullopt;
        const std::span<const std::byte> taken = left_.first(static_cast<std::size_t>(count));
        left_ = left_.subspan(taken.size());
        return taken;
    }

    template <class Integer>
    std::optional<Integer> take_integer() {
        const auto bytes = take(sizeof(Integer));
        if (!bytes) return std::nullopt;
        Integer value;
        std::memcpy(&value, bytes->data(), sizeof value);
        return value;
    }

    /// A length of type `Length`, then as many bytes.
    template <class Length>
    std::optional<std::span<const std::byte>> take_block() {
        const auto length = take_integer<Length>();
        return length ? take(*length) : std::nullopt;
    }

private:
    std::span<const std::byte> left_;
};

std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void CheckpointWriter::add(std::string_view name, std::span<const std::byte> bytes) {
    assert(std::ranges::none_of(sections_, [&](const Section& s) { return s.name == name; }));
    sections_.push_back({std::string(name), {bytes.begin(), bytes.end()}});
}

void CheckpointWriter::write(const std::filesystem::path& path) const {
    AtomicFile file(path);
    Hasher hasher;
    const auto put = [&](std::span<const std::byte> bytes) {
        file.write(bytes);
        hasher.add(bytes);
    };
    const auto put_integer = [&](const auto& value) { put(std::as_bytes(std::span(&value, 1))); };
    const auto put_text = [&](std::string_view text) {
        put_integer(static_cast<std::uint32_t>(text.size()));
        put(std::as_bytes(std::span(text)));
    };
    constexpr std::string_view library = version;

    // Size of the whole, for the header.
    std::uint64_t size = sizeof(Header) + 4 + library.size() + 4 + hash_size;
    for (const Section& section : sections_) size += 4 + section.name.size() + 8 + section.bytes.size();

    // Header, sections, hash.
    Header header{{}, checkpoint_format, byte_order, size};
    std::ranges::copy(magic, header.magic);
    put_integer(header);
    put_text(library);
    put_integer(static_cast<std::uint32_t>(sections_.size()));
    for (const Section& section : sections_) {
        put_text(section.name);
        put_integer(static_cast<std::uint64_t>(section.bytes.size()));
        put(section.bytes);
    }
    file.write_value(hasher.value());
    file.commit();
}

CheckpointReader::CheckpointReader(const std::filesystem::path& path) : path_(path.string()) {
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (error) refuse(error.message() + "; give the path of a checkpoint that a run of phyxel wrote");
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse("it cannot be opened; check that you may read it");
    const std::string remedy = "; resume from another checkpoint, or start the run anew";

    // The header, by itself: it says what this file is and how long it should be.
    Header header{};
    file.read(reinterpret_cast<char*>(&header), sizeof header);
    const auto found = static_cast<std::size_t>(file.gcount());
    if (found == 0) refuse("the file is empty" + remedy);
    if (std::string_view(header.magic, std::min(found, magic.size())) != magic.substr(0, found))
        refuse("it is not a checkpoint of phyxel (it does not begin with PHYXELCP)");
    if (found < sizeof header) refuse("it ends within its header, after " + std::to_string(found) + " bytes" + remedy);
    if (header.byte_order == other_byte_order) refuse("it was written on a machine of the other byte order");
    if (header.byte_order != byte_order) refuse("it is damaged: the mark of the byte order is wrong" + remedy);
    if (header.format != checkpoint_format)
        refuse("it is of format " + std::to_string(header.format) + ", this version (" + std::string(version) +
               ") reads format " + std::to_string(checkpoint_format) + "; resume with the version that wrote it");
    if (header.file_size != size)
        refuse("it is damaged: it holds " + std::to_string(size) + " bytes, its header announces " +
               std::to_string(header.file_size) + remedy);

    // Everything, and its hash.
    bytes_.resize(static_cast<std::size_t>(size));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
    if (static_cast<std::uint64_t>(file.gcount()) != size) refuse("it could not be read to its end" + remedy);
    if (size < sizeof header + hash_size) refuse("it is damaged: it ends before its checksum" + remedy);
    const auto content = std::span<const std::byte>(bytes_).first(bytes_.size() - hash_size);
    std::uint64_t expected;
    std::memcpy(&expected, content.data() + content.size(), hash_size);
    if (hash64(content) != expected) refuse("it is damaged: its checksum does not match its content" + remedy);
    parse(content.subspan(sizeof header));
}

void CheckpointReader::parse(std::span<const std::byte> content) {
    const std::string impossible = "it was not written by phyxel: a length in it exceeds the file";
    Cursor cursor(content);
    const auto library = cursor.take_block<std::uint32_t>();
    const auto count = cursor.take_integer<std::uint32_t>();
    if (!library || !count) refuse(impossible);
    library_version_ = as_text(*library);
    for (std::uint32_t i = 0; i < *count; ++i) {
        const auto name = cursor.take_block<std::uint32_t>();
        const auto bytes = cursor.take_block<std::uint64_t>();
        if (!name || !bytes) refuse(impossible);
        sections_.push_back({as_text(*name), *bytes});
    }
    if (!cursor.at_end()) refuse("it was not written by phyxel: bytes follow its last section");
}

bool CheckpointReader::has(std::string_view name) const {
    return std::ranges::any_of(sections_, [&](const Section& s) { return s.name == name; });
}

std::span<const std::byte> CheckpointReader::section(std::string_view name) const {
    const auto found = std::ranges::find(sections_, name, &Section::name);
    if (found == sections_.end())
        refuse("it has no section \"" + std::string(name) + "\"; resume with the version that wrote it (" +
               library_version_ + ")");
    return found->bytes;
}

std::string CheckpointReader::text(std::string_view name) const { return std::string(as_text(section(name))); }

void CheckpointReader::refuse(const std::string& reason) const {
    throw Error("cannot resume from " + path_ + ": " + reason);
}

void CheckpointReader::refuse_size(std::string_view name, std::size_t found, std::size_t value_size,
                                   std::size_t count) const {
    const std::string expected = count > 0 ? std::to_string(count) + " values" : "values";
    refuse("its section \"" + std::string(name) + "\" holds " + std::to_string(found) + " bytes, expected " + expected +
           " of " + std::to_string(value_size) + " bytes; the checkpoint is of another scene or another version (" +
           library_version_ + ")");
}

}  // namespace phyxel
