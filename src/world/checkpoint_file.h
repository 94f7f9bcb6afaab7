#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace phyxel {

/// The container of a checkpoint: named sections of bytes in one file, little endian,
///
///     "PHYXELCP"  magic
///     uint32      format version, `checkpoint_format`
///     uint32      0x01020304, the mark of the byte order
///     uint64      size of the whole file [bytes]
///     uint32, ..  length and bytes of the library's version
///     uint32      number of sections, each: uint32 length and bytes of its name, uint64 size and bytes of its content
///     uint64      XXH64 of everything before
///
/// What a section means is the business of whoever adds it.
inline constexpr std::uint32_t checkpoint_format = 1;

/// Collects sections, then writes them atomically.
class CheckpointWriter {
public:
    /// Adds a copy of `bytes` under a name that was not used before.
    void add(std::string_view name, std::span<const std::byte> bytes);
    void add(std::string_view name, std::string_view text) { add(name, std::as_bytes(std::span(text))); }

    template <class T>
    void add_values(std::string_view name, std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        add(name, std::as_bytes(values));
    }
    template <class T>
    void add_value(std::string_view name, const T& value) {
        add_values(name, std::span<const T>(&value, 1));
    }

    void write(const std::filesystem::path& path) const;

private:
    struct Section {
        std::string name;
        std::vector<std::byte> bytes;
    };
    std::vector<Section> sections_;
};

/// Reads and checks a whole file. A file that is damaged, cut off, foreign, or of another format is an `Error` that
/// says which; so is a section that is missing or not of the size that its reader expects.
class CheckpointReader {
public:
    explicit CheckpointReader(const std::filesystem::path& path);

    /// Version of the library that wrote the file.
    const std::string& library_version() const { return library_version_; }

    bool has(std::string_view name) const;
    std::span<const std::byte> section(std::string_view name) const;
    std::string text(std::string_view name) const;

    /// The section as an array; its size must be a multiple of a value's.
    template <class T>
    std::vector<T> values(std::string_view name) const {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::span<const std::byte> bytes = section(name);
        if (bytes.size() % sizeof(T) != 0) refuse_size(name, bytes.size(), sizeof(T));
        std::vector<T> result(bytes.size() / sizeof(T));
        if (!result.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
        return result;
    }
    /// The section as an array of exactly `count` values.
    template <class T>
    std::vector<T> values(std::string_view name, std::size_t count) const {
        const std::size_t size = section(name).size();
        if (size / sizeof(T) != count || size % sizeof(T) != 0) refuse_size(name, size, sizeof(T), count);
        return values<T>(name);
    }
    template <class T>
    T value(std::string_view name) const {
        return values<T>(name, 1).front();
    }

private:
    struct Section {
        std::string_view name;
        std::span<const std::byte> bytes;
    };

    void parse(std::span<const std::byte> content);
    [[noreturn]] void refuse(const std::string& reason) const;
    [[noreturn]] void refuse_size(std::string_view name, std::size_t found, std::size_t value_size,
                                  std::size_t count = 0) const;

    std::string path_;
    std::vector<std::byte> bytes_;  // the file as it is; sections point into it
    std::string library_version_;
    std::vector<Section> sections_;
};

}  // namespace phyxel
