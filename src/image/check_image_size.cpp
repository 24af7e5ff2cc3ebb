#include "image/check_image_size.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {

void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t decoded_bytes,
                      uint64_t file_bytes, uint64_t max_per_byte) {
    if (width == 0 || height == 0)
        throw Error(ErrorCode::BadInput, FileLocation{name},
                    fmt::format("the header states {} x {} pixels; both sides must be at least 1", width, height));
    const uint64_t could_hold = multiply_saturated(file_bytes, max_per_byte);
    if (decoded_bytes > kImageBytesAlwaysAllowed && decoded_bytes - kImageBytesAlwaysAllowed > could_hold)
        throw Error(
            ErrorCode::BadInput, FileLocation{name},
            fmt::format(
                "the header states {} x {} pixels, which {} bytes cannot hold; the file is damaged or truncated", width,
                height, file_bytes));
    if (width > kMaxImageSide || height > kMaxImageSide || multiply_saturated(width, height) > kMaxImagePixels)
        throw Error(ErrorCode::OverLimit, FileLocation{name},
                    fmt::format("{} x {} pixels; the limits are {} per side and {} in total", width, height,
                                kMaxImageSide, kMaxImagePixels));
    check_decoded_bytes(name, decoded_bytes, file_bytes);
}

void check_decoded_bytes(const std::string& name, uint64_t decoded_bytes, uint64_t file_bytes) {
    if (decoded_bytes <= justified_bytes(kFreeImageBytes, file_bytes)) return;
    throw Error(ErrorCode::OverLimit, FileLocation{name},
                fmt::format("the pixels take {} MiB of memory; the limit for a picture file of {} bytes is {} MiB "
                            "plus {} times the file's size; make the picture smaller",
                            decoded_bytes >> 20, file_bytes, kFreeImageBytes >> 20, kMaxExpansion));
}

} // namespace pertev
