#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace phyxel {

/// A file that appears whole or not at all: bytes go to a temporary sibling, `.NAME.part`, which `commit` renames onto
/// the target. A writer that is destroyed, throws or is killed before that leaves the target as it was.
/// Every error of the system is an `Error` that names the file, the reason and what to do about it.
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::span<const std::byte> bytes);
    void write(std::string_view text) { write(std::as_bytes(std::span(text))); }

    /// The values' own bytes, in the machine's order.
    template <class T>
    void write_values(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        write(std::as_bytes(values));
    }
    template <class T>
    void write_value(const T& value) {
        write_values(std::span<const T>(&value, 1));
    }

    /// Replaces bytes that were written before, at `offset` from the start (headers that hold a length).
    void overwrite(std::uint64_t offset, std::span<const std::byte> bytes);

    /// Bytes written so far.
    std::uint64_t size() const { return size_; }
    const std::filesystem::path& target() const { return target_; }

    /// Flushes, closes and renames onto the target. Nothing may be written afterwards.
    void commit();

private:
    void flush();
    void write_at_once(const std::byte* bytes, std::size_t count);

    std::filesystem::path target_, temporary_;
    std::vector<std::byte> buffer_;
    std::uint64_t size_ = 0;
    int descriptor_ = -1;
};

/// Writes `content` to `path` as a whole, atomically.
void write_file(const std::filesystem::path& path, std::string_view content);

/// Creates a folder and those above it, unless they exist. `Error` when that cannot be, or when it cannot be written
/// to.
void create_folder(const std::filesystem::path& folder);

}  // namespace phyxel
