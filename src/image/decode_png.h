#pragma once

// PNG by libpng: every colour type and depth, palettes, transparency, interlacing. Called by decode_image, which says
// what the results hold. Only the chunks that change pixel values are looked at.

#include <cstddef>
#include <span>
#include <string>
#include <variant>

#include "base/messages.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// See decode_image.
std::variant<Rgba8Image, Image> decode_png(std::span<const std::byte> bytes, const std::string& name,
                                           Messages* messages);
/// See read_image_header.
ImageHeader read_png_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
