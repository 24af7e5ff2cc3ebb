#include "image/write_image.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "base/write_file_atomically.h"
#include "image/tone_map_image.h"
#include "image/write_hdr.h"
#include "image/write_jpeg.h"
#include "image/write_png.h"

namespace pertev {

ImageFormat image_format_for(const std::filesystem::path& path) {
    const std::string extension = lower_case_extension(path);
    if (extension == ".exr") return ImageFormat::Exr;
    if (extension == ".png") return ImageFormat::Png;
    if (extension == ".jpg" || extension == ".jpeg") return ImageFormat::Jpeg;
    if (extension == ".hdr") return ImageFormat::Hdr;
    throw Error(ErrorCode::BadInput, FileLocation{path.string()},
                fmt::format("{}; a picture is written as .exr, .png, .jpg (.jpeg) or .hdr",
                            extension.empty() ? "the file's name has no extension"
                                              : fmt::format("unknown extension {}", extension)));
}

void check_image_output(const std::filesystem::path& path, uint32_t width, uint32_t height) {
    if (image_format_for(path) == ImageFormat::Jpeg) check_jpeg_size({FileLocation{path.string()}, ""}, width, height);
    check_writable(path);
}

void write_image(const std::filesystem::path& path, const Image& linear, const WriteImageOptions& options) {
    switch (image_format_for(path)) {
    case ImageFormat::Exr:
        return write_exr(path, linear, options.layers, options.metadata, options.place);
    case ImageFormat::Hdr:
        return write_hdr(path, linear);
    case ImageFormat::Png:
        return write_png(path, tone_map_image(linear, options.tone_map, options.exposure_stops, options.transparent),
                         options.transparent && linear.channels % 2 == 0);
    case ImageFormat::Jpeg:
        return write_jpeg(path, tone_map_image(linear, options.tone_map, options.exposure_stops, false));
    }
}

} // namespace pertev
