#include "image/image_format.h"

#include <algorithm>
#include <string_view>

#include "base/file_extension.h"

namespace pertev {

std::optional<ImageFormat> recognise_image(std::span<const std::byte> bytes) {
    const std::string_view start(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
    if (start.starts_with("\x89PNG\r\n\x1a\n")) return ImageFormat::Png;
    if (start.starts_with("\xff\xd8\xff")) return ImageFormat::Jpeg;
    if (start.starts_with("#?RADIANCE") || start.starts_with("#?RGBE")) return ImageFormat::Hdr;
    if (start.starts_with("\x76\x2f\x31\x01")) return ImageFormat::Exr;
    return std::nullopt;
}

bool is_picture_name(const std::filesystem::path& file) {
    return std::ranges::find(kPictureExtensions, lower_case_extension(file)) != std::end(kPictureExtensions);
}

} // namespace pertev
