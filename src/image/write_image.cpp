#include "image/write_image.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "base/write_file_atomically.h"
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
        return write_exr(path, linear, options.layers, options.metadata, options.place, options.numbers.exr_colors);
    case ImageFormat::Hdr:
        return write_hdr(path, linear);
    case ImageFormat::Png: {
        const bool has_alpha = options.transparent && linear.channels % 2 == 0;
        if (options.numbers.png_has_16_bits)
            return write_png(path, display_image_16(linear, options.display, options.transparent), has_alpha);
        return write_png(path, display_image(linear, options.display, options.transparent), has_alpha);
    }
    case ImageFormat::Jpeg:
        return write_jpeg(path, display_image(linear, options.display, false));
    }
}

} // namespace pertev
