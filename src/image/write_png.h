#pragma once

// Writes PNG of 8 or 16 bits, marked as sRGB. Equal pictures give equal bytes with one version of zlib.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "image/image.h"
#include "image/rgba16_image.h"

namespace pertev {

/// RGB, or RGBA with `with_alpha` (not premultiplied).
std::vector<std::byte> encode_png(const Rgba8Image& picture, bool with_alpha = false);
std::vector<std::byte> encode_png(const Rgba16Image& picture, bool with_alpha = false);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_png(const std::filesystem::path& path, const Rgba8Image& picture, bool with_alpha = false);
void write_png(const std::filesystem::path& path, const Rgba16Image& picture, bool with_alpha = false);

} // namespace pertev
