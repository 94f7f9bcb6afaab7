#include "io/video.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>

#include "phyxel/error.h"

namespace phyxel {
namespace {

/// A fresh folder for one test, removed with it.
struct Folder {
    std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) /
        fmt::format("video_test_{}_{}", ::getpid(), testing::UnitTest::GetInstance()->current_test_info()->name());
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    bool empty() const { return std::filesystem::is_empty(path); }
};

/// A plain picture; noise, where the film must become large.
Picture picture(int width, int height, int shade, bool noise = false) {
    Picture p{width, height, {}};
    p.rgb.resize(p.row_bytes() * static_cast<std::size_t>(height), static_cast<std::uint8_t>(shade));
    unsigned state = 1u + static_cast<unsigned>(shade);
    if (noise)
        for (std::uint8_t& byte : p.rgb)
            byte = static_cast<std::uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
    return p;
}

/// "width,height,pictures,seconds" as ffprobe counts them.
std::string probe(const std::filesystem::path& film) {
    const std::string command =
        "ffprobe -v error -count_frames -select_streams v:0 -show_entries "
        "stream=width,height,nb_read_frames:stream=duration -of csv=p=0 '" +
        film.string() + "'";
    std::string answer;
    FILE* pipe = ::popen(command.c_str(), "r");
    for (int c; (c = std::fgetc(pipe)) != EOF;)
        if (c != '\n') answer += static_cast<char>(c);
    ::pclose(pipe);
    return answer;
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Video, film_has_the_size_the_pictures_and_the_duration) {
    const Folder folder;
    Mp4Writer film(folder.path / "film.mp4", 160, 90, 30);
    for (int i = 0; i < 45; ++i) film.add(picture(160, 90, 5 * i));
    film.finish();
    EXPECT_EQ(probe(folder.path / "film.mp4"), "160,90,1.500000,45");
}

TEST(Video, a_rate_that_is_no_whole_number_and_odd_sizes_are_honoured) {
    const Folder folder;
    Mp4Writer film(folder.path / "a 'film'.mp4", 33, 17, 12.5);
    for (int i = 0; i < 5; ++i) film.add(picture(33, 17, 40 * i));
    film.finish();
    std::filesystem::rename(folder.path / "a 'film'.mp4", folder.path / "film.mp4");
    EXPECT_EQ(probe(folder.path / "film.mp4"), "34,18,0.400000,5");
}

TEST(Video, an_unfinished_film_leaves_nothing) {
    const Folder folder;
    { Mp4Writer film(folder.path / "film.mp4", 64, 64, 30); }
    {
        Mp4Writer film(folder.path / "film.mp4", 64, 64, 30);
        for (int i = 0; i < 50; ++i) film.add(picture(64, 64, i));
    }
    EXPECT_TRUE(folder.empty());
}

TEST(Video, a_film_without_pictures_is_an_error) {
    const Folder folder;
    EXPECT_NE(message_of([&] { Mp4Writer(folder.path / "film.mp4", 64, 64, 30).finish(); }).find("no picture"),
              std::string::npos);
    EXPECT_TRUE(folder.empty());
}

TEST(Video, a_picture_of_another_size_is_refused) {
    const Folder folder;
    Mp4Writer film(folder.path / "film.mp4", 64, 64, 30);
    EXPECT_NE(message_of([&] { film.add(picture(64, 32, 0)); }).find("64 x 32"), std::string::npos);
}

TEST(Video, a_folder_that_does_not_exist_gives_ffmpegs_reason_and_no_signal) {
    const std::string message = message_of([] {
        Mp4Writer film("/no such folder/film.mp4", 640, 480, 30);
        for (int i = 0; i < 100; ++i) film.add(picture(640, 480, 2 * i));
        film.finish();
    });
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

/// Runs in a child process and prints the message there.
void write_film_and_exit(const std::filesystem::path& path, int pictures) {
    std::cerr << message_of([&] {
        Mp4Writer film(path, 160, 120, 30);
        for (int i = 0; i < pictures; ++i) film.add(picture(160, 120, i, true));
        film.finish();
    });
    std::exit(3);
}

TEST(VideoDeathTest, without_ffmpeg_the_error_says_what_to_install) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const Folder folder;
    EXPECT_EXIT(
        {
            ::setenv("PATH", "/nowhere", 1);
            write_film_and_exit(folder.path / "film.mp4", 1);
        },
        testing::ExitedWithCode(3), "install ffmpeg or leave mp4 out of output.formats");
    EXPECT_TRUE(folder.empty());
}

TEST(VideoDeathTest, ffmpeg_that_dies_while_writing_is_an_error_and_leaves_nothing) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const Folder folder;
    const auto write_with_little_room = [&] {
        // Writing beyond the limit fails, as on a full disk.
        rlimit limit{};
        ::getrlimit(RLIMIT_FSIZE, &limit);
        limit.rlim_cur = 100000;
        ::setrlimit(RLIMIT_FSIZE, &limit);
        ::signal(SIGXFSZ, SIG_IGN);
        write_film_and_exit(folder.path / "film.mp4", 60);
    };
    EXPECT_EXIT(write_with_little_room(), testing::ExitedWithCode(3), "ffmpeg failed: .*film.mp4");
    EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace phyxel
