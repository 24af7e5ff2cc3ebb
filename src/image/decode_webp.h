#pragma once

// Decodes WebP by libwebp, if the build has it (docs/dependencies.md). Its lossy and lossless decoders are integer
// arithmetic that gives the same pixels on every processor.

#include <cstddef>
#include <span>
#include <string>

#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// Returns whether this build decodes WebP.
bool has_webp();

/// Returns whether `bytes` begin as a WebP file does.
bool is_webp(std::span<const std::byte> bytes);

// Each throws Error(BadInput) that starts with `name` for data that is damaged, truncated or animated, and in a build
// without libwebp; and as check_image_size() does.
ImageHeader read_webp_header(std::span<const std::byte> bytes, const std::string& name);
Rgba8Image decode_webp(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
