#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

#include "phyxel/error.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::read_bytes;
using test::TemporaryDirectory;

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/// Runs `action` in a process of its own; returns what waitpid says of its end.
int in_child(const std::function<int()>& action) {
    const pid_t child = fork();
    if (child == 0) _exit(action());
    int status = 0;
    waitpid(child, &status, 0);
    return status;
}

bool is_empty(const TemporaryDirectory& folder) { return std::filesystem::is_empty(folder.path()); }

TEST(AtomicFile, appears_at_commit_and_not_before) {
    const TemporaryDirectory folder;
    AtomicFile file(folder / "a.txt");
    file.write("hello");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.commit();
    EXPECT_EQ(read_bytes(folder / "a.txt"), "hello");
    EXPECT_FALSE(std::filesystem::exists(folder / ".a.txt.part"));
}

TEST(AtomicFile, leaves_nothing_and_the_old_content_without_commit) {
    const TemporaryDirectory folder;
    write_file(folder / "old.txt", "old");
    {
        AtomicFile fresh(folder / "fresh.txt"), old(folder / "old.txt");
        fresh.write("new");
        old.write("new");
    }
    EXPECT_EQ(read_bytes(folder / "old.txt"), "old");
    std::filesystem::remove(folder / "old.txt");
    EXPECT_TRUE(is_empty(folder));
}

TEST(AtomicFile, holds_small_and_large_pieces_in_order) {
    const TemporaryDirectory folder;
    std::string expected;
    AtomicFile file(folder / "a.bin");
    for (std::size_t i = 0; i < 40; ++i) {
        const std::string piece(i * i * i * 13, static_cast<char>('a' + i % 26));
        file.write(piece);
        expected += piece;
    }
    EXPECT_EQ(file.size(), expected.size());
    file.overwrite(3, std::as_bytes(std::span(std::string_view("HEAD"))));
    expected.replace(3, 4, "HEAD");
    file.write("tail");
    file.commit();
    EXPECT_TRUE(read_bytes(folder / "a.bin") == expected + "tail");
}

TEST(AtomicFile, says_that_the_disk_is_full_and_leaves_nothing) {
    const TemporaryDirectory folder;
    std::filesystem::create_symlink("/dev/full", folder / ".a.bin.part");
    const std::string message = error_of([&] { write_file(folder / "a.bin", "x"); });
    EXPECT_NE(message.find("no space left on " + folder.path().string() + " while writing"), std::string::npos)
        << message;
    EXPECT_NE(message.find("with -o"), std::string::npos) << message;
    EXPECT_TRUE(is_empty(folder));
}

TEST(AtomicFile, says_that_a_limit_was_reached_in_the_middle_and_leaves_nothing) {
    const TemporaryDirectory folder;
    const int status = in_child([&] {
        signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1 << 20, 1 << 20};
        setrlimit(RLIMIT_FSIZE, &limit);
        const std::string message = error_of([&] { write_file(folder / "a.bin", std::string(3 << 20, 'x')); });
        return message.find("File too large") == std::string::npos ? 1 : 0;
    });
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(is_empty(folder));
}

TEST(AtomicFile, of_a_killed_process_is_not_there) {
    const TemporaryDirectory folder;
    write_file(folder / "old.bin", "old");
    const int status = in_child([&] {
        AtomicFile old(folder / "old.bin"), fresh(folder / "fresh.bin");
        old.write(std::string(1 << 20, 'x'));
        fresh.write(std::string(1 << 20, 'x'));
        return raise(SIGKILL);
    });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(read_bytes(folder / "old.bin"), "old");
    EXPECT_FALSE(std::filesystem::exists(folder / "fresh.bin"));

    // The next run takes the left-over's place.
    write_file(folder / "fresh.bin", "fresh");
    EXPECT_EQ(read_bytes(folder / "fresh.bin"), "fresh");
    EXPECT_FALSE(std::filesystem::exists(folder / ".fresh.bin.part"));
}

TEST(AtomicFile, names_the_reason_and_the_remedy_when_the_folder_does_not_allow_it) {
    const TemporaryDirectory folder;
    write_file(folder / "file", "x");
    std::filesystem::create_directory(folder / "taken");
    struct Row {
        std::filesystem::path path;
        const char* reason;
    };
    for (const Row& row : {Row{folder / "missing/a.bin", "No such file or directory; create the folder first"},
                           Row{folder / "file/a.bin", "Not a directory"}, Row{folder / "taken", "Is a directory"},
                           Row{"/proc/a.bin", "cannot write /proc/a.bin"}}) {
        const std::string message = error_of([&] { write_file(row.path, "x"); });
        EXPECT_NE(message.find(row.reason), std::string::npos) << message;
        EXPECT_NE(message.find("with -o"), std::string::npos) << message;
    }
}

TEST(CreateFolder, makes_the_whole_way_and_accepts_what_is_there) {
    const TemporaryDirectory folder;
    create_folder(folder / "a/b/c");
    create_folder(folder / "a/b/c");
    EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
}

TEST(CreateFolder, names_the_reason_when_it_cannot) {
    const TemporaryDirectory folder;
    write_file(folder / "file", "x");
    for (const std::filesystem::path& path : {folder / "file", folder / "file/below", std::filesystem::path("/proc/x")})
        EXPECT_NE(error_of([&] { create_folder(path); }).find(path.string() + ": "), std::string::npos) << path;
}

}  // namespace
}  // namespace phyxel
