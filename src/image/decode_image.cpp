#include "image/decode_image.h"

#include <fmt/format.h>

#include "base/error.h"
#include "image/decode_exr.h"
#include "image/decode_hdr.h"
#include "image/decode_jpeg.h"
#include "image/decode_png.h"
#include "image/image_format.h"

namespace pertev {

std::variant<Rgba8Image, Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                                             Messages* messages) {
    const std::optional<ImageFormat> format = recognise_image(bytes);
    if (!format)
        throw Error(
            ErrorCode::BadInput,
            fmt::format("{}: {}; a picture must be PNG, JPEG, Radiance HDR or OpenEXR", name,
                        bytes.empty() ? "the file is empty" : "its first bytes are of no known picture format"));
    switch (*format) {
    case ImageFormat::Png:
        return decode_png(bytes, name, messages);
    case ImageFormat::Jpeg:
        return decode_jpeg(bytes, name, messages);
    case ImageFormat::Hdr:
        return decode_hdr(bytes, name);
    case ImageFormat::Exr:
        return decode_exr(bytes, name);
    }
    check_failed("a known image format", __FILE__, __LINE__);
}

} // namespace pertev
