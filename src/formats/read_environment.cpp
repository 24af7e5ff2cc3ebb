#include "formats/read_environment.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/file_extension.h"
#include "image/read_image.h"

namespace pertev {

Image read_environment_image(const std::filesystem::path& path, Sink& sink) {
    Image image = read_image(path, sink);
    if (image.width != 2 * image.height) {
        sink.warn({FileLocation{path.string()},
                   fmt::format("{}x{} is not twice as wide as high; it is used as a full panorama anyway", image.width,
                               image.height)});
    }
    if (image.channels == 4) { // alpha means nothing here
        const std::size_t count = image.pixels.size() / 4;
        for (std::size_t i = 1; i < count; ++i) std::copy_n(&image.pixels[4 * i], 3, &image.pixels[3 * i]);
        image.pixels.resize(3 * count);
        image.channels = 3;
    }
    const std::string extension = lower_case_extension(path);
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg") {
        sink.warn(
            {FileLocation{path.string()}, "8-bit pictures clip bright light; an .hdr or .exr has the full range"});
    }
    return image;
}

} // namespace pertev
