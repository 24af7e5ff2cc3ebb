#pragma once

// Writes JPEG by libjpeg-turbo: slow integer DCT, no chroma subsampling. Alpha is left out.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "image/image.h"

namespace pertev {

/// `quality`: libjpeg's scale, 1 to 100. Sides are at most 65500 pixels (the format's limit; OverLimit above).
std::vector<std::byte> encode_jpeg(const Rgba8Image& picture, int quality = 95);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_jpeg(const std::filesystem::path& path, const Rgba8Image& picture, int quality = 95);

} // namespace pertev
