#pragma once

// Writes JPEG with libjpeg-turbo: slow integer DCT; without chroma subsampling by default. Alpha is dropped.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/remark.h"
#include "image/image.h"

namespace pertev {

/// Throws Error(OverLimit) about `what`, a file or a setting, for a side of more than 65500 pixels, the format's limit.
void check_jpeg_size(Remark what, uint32_t width, uint32_t height);

/// `quality`: libjpeg's scale, 1 to 100. Throws as check_jpeg_size.
std::vector<std::byte> encode_jpeg(const Rgba8Image& picture, int quality = 95);

/// Encodes the picture on all threads: strips of rows in parallel, joined by restart markers to one file. It decodes
/// to the same pixels as encode_jpeg. `half_chroma` stores colour at half the resolution, which is smaller and
/// faster. Throws as check_jpeg_size.
std::vector<std::byte> encode_jpeg_strips(const Rgba8Image& picture, int quality, bool half_chroma);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_jpeg(const std::filesystem::path& path, const Rgba8Image& picture, int quality = 95);

} // namespace pertev
