#pragma once

// Decodes PNG with libpng: every colour type and depth, palettes, transparency, interlacing. decode_image calls it
// and describes the results. Only chunks that affect pixel values are read.

#include <cstddef>
#include <span>
#include <string>
#include <variant>

#include "base/sink.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// Decodes a PNG file under the contract of decode_image.
std::variant<Rgba8Image, Image> decode_png(std::span<const std::byte> bytes, const std::string& name, Sink& sink);
/// Reads the header of a PNG file under the contract of read_image_header.
ImageHeader read_png_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
