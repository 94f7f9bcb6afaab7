#include "io/image.h"

#include <png.h>

#include <span>
#include <vector>

#include "base/atomic_file.h"
#include "phyxel/error.h"

namespace phyxel {

void write_png(const std::filesystem::path& path, const Picture& picture) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    image.flags = PNG_IMAGE_FLAG_FAST;

    // In memory first: a file that is whole or absent is the atomic file's work, not libpng's.
    std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr))
        throw Error("cannot write " + path.string() + ": libpng says: " + image.message);
    AtomicFile file(path);
    file.write(std::span(bytes).first(size));
    file.commit();
}

}  // namespace phyxel
