#pragma once

// Writes 8-bit PNG, marked as sRGB. Equal pictures give equal bytes with one version of zlib.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "image/image.h"

namespace pertev {

/// RGB, or RGBA with `with_alpha` (not premultiplied).
std::vector<std::byte> encode_png(const Rgba8Image& picture, bool with_alpha = false);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_png(const std::filesystem::path& path, const Rgba8Image& picture, bool with_alpha = false);

} // namespace pertev
