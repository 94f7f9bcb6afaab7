#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "phyxel/error.h"

namespace phyxel {
namespace {

constexpr std::size_t buffer_size = std::size_t(1) << 18;  // large enough that system calls cost nothing

/// What the user can do about an error of the system.
const char* remedy(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT:
            return "free some or choose another folder with -o";
        case EFBIG:
            return "raise the limit (ulimit -f), or write less in one file";
        case EACCES:
        case EPERM:
        case EROFS:
            return "choose a folder that you may write to with -o";
        case ENOENT:
            return "create the folder first, or choose another with -o";
        case ENOTDIR:
        case EISDIR:
            return "move what is in the way, or choose another folder with -o";
        default:
            return "choose another folder with -o";
    }
}

[[noreturn]] void fail_writing(const std::filesystem::path& file, int error) {
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    if (error == ENOSPC || error == EDQUOT)
        throw Error("no space left on " + folder + " while writing " + file.string() + ": " + remedy(error));
    throw Error("cannot write " + file.string() + ": " + std::generic_category().message(error) + "; " + remedy(error));
}

std::filesystem::path temporary_of(const std::filesystem::path& target) {
    std::string name = ".";
    name += target.filename().string();
    name += ".part";
    return target.parent_path() / name;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)), temporary_(temporary_of(target_)) {
    std::error_code ignored;
    if (target_.filename().empty() || std::filesystem::is_directory(target_, ignored)) fail_writing(target_, EISDIR);
    buffer_.reserve(buffer_size);
    descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail_writing(target_, errno);
}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
    size_ += bytes.size();
    if (buffer_.size() + bytes.size() > buffer_size) flush();
    if (bytes.size() > buffer_size) write_at_once(bytes.data(), bytes.size());
    else buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void AtomicFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
    flush();
    while (!bytes.empty()) {
        const ::ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<::off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_writing(target_, errno);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
        offset += static_cast<std::uint64_t>(written);
    }
}

void AtomicFile::commit() {
    flush();
    if (::close(std::exchange(descriptor_, -1)) != 0 || std::rename(temporary_.c_str(), target_.c_str()) != 0) {
        const int error = errno;
        ::unlink(temporary_.c_str());
        fail_writing(target_, error);
    }
}

void AtomicFile::flush() {
    write_at_once(buffer_.data(), buffer_.size());
    buffer_.clear();
}

void AtomicFile::write_at_once(const std::byte* bytes, std::size_t count) {
    while (count > 0) {
        const ::ssize_t written = ::write(descriptor_, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_writing(target_, errno);
        bytes += written;
        count -= static_cast<std::size_t>(written);
    }
}

void write_file(const std::filesystem::path& path, std::string_view content) {
    AtomicFile file(path);
    file.write(content);
    file.commit();
}

void create_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && !std::filesystem::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
    if (!error && ::access(folder.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
    if (error)
        throw Error("cannot use the folder " + folder.string() + ": " + error.message() + "; " + remedy(error.value()));
}

}  // namespace phyxel
