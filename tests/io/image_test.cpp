#include "io/image.h"

#include <gtest/gtest.h>
#include <png.h>

#include "phyxel/error.h"

namespace phyxel {
namespace {

/// A picture in which every pixel differs from its neighbours.
Picture pattern(int width, int height) {
    Picture picture{width, height, {}};
    for (int i = 0; i < width * height * 3; ++i) picture.rgb.push_back(static_cast<std::uint8_t>(i * 7 + i / 251));
    return picture;
}

Picture read_png(const std::filesystem::path& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_file(&image, path.c_str())) << image.message;
    image.format = PNG_FORMAT_RGB;
    Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
    picture.rgb.resize(PNG_IMAGE_SIZE(image));
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr)) << image.message;
    return picture;
}

TEST(Image, png_gives_back_the_same_bytes) {
    const auto path = std::filesystem::path(testing::TempDir()) / "image_test.png";
    for (const Picture& picture : {pattern(64, 48), pattern(33, 7), pattern(1, 1)}) {
        write_png(path, picture);
        const Picture read = read_png(path);
        EXPECT_EQ(read.width, picture.width);
        EXPECT_EQ(read.height, picture.height);
        EXPECT_EQ(read.rgb, picture.rgb);
    }
    std::filesystem::remove(path);
}

TEST(Image, a_folder_that_does_not_exist_is_named) {
    try {
        write_png("/no such folder/a.png", pattern(4, 4));
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("/no such folder"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace phyxel
