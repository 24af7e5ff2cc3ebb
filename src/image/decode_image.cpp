#include "image/decode_image.h"

#include <fmt/format.h>

#include "base/error.h"
#include "image/check_exr_header.h"
#include "image/decode_exr.h"
#include "image/decode_hdr.h"
#include "image/decode_jpeg.h"
#include "image/decode_png.h"
#include "image/decode_webp.h"
#include "image/image_format.h"

namespace pertev {

namespace {

ImageFormat format_of(std::span<const std::byte> bytes, const std::string& name) {
    if (const std::optional<ImageFormat> format = recognise_image(bytes)) return *format;
    throw Error(ErrorCode::BadInput, FileLocation{name},
                fmt::format("{}; a picture must be PNG, JPEG, WebP, Radiance HDR or OpenEXR",
                            bytes.empty() ? "the file is empty" : "the file has no known picture format"));
}

} // namespace

ImageHeader read_image_header(std::span<const std::byte> bytes, const std::string& name) {
    if (is_webp(bytes)) return read_webp_header(bytes, name);
    switch (format_of(bytes, name)) {
    case ImageFormat::Png:
        return read_png_header(bytes, name);
    case ImageFormat::Jpeg:
        return read_jpeg_header(bytes, name);
    case ImageFormat::Hdr:
        return read_hdr_header(bytes, name);
    case ImageFormat::Exr:
        return check_exr_header(bytes, name);
    }
    check_failed("a known image format", __FILE__, __LINE__);
}

std::variant<Rgba8Image, Image> decode_image(std::span<const std::byte> bytes, const std::string& name, Sink& sink) {
    if (is_webp(bytes)) return decode_webp(bytes, name);
    switch (format_of(bytes, name)) {
    case ImageFormat::Png:
        return decode_png(bytes, name, sink);
    case ImageFormat::Jpeg:
        return decode_jpeg(bytes, name, sink);
    case ImageFormat::Hdr:
        return decode_hdr(bytes, name);
    case ImageFormat::Exr:
        return decode_exr(bytes, name);
    }
    check_failed("a known image format", __FILE__, __LINE__);
}

} // namespace pertev
