#pragma once

// Decodes JPEG with libjpeg-turbo: baseline and progressive; grey, YCbCr, RGB, CMYK and YCCK. decode_image calls it
// and describes the result. It uses the slow integer DCT and the library's exact up-sampling, whose SIMD versions
// give the same bytes as its C version, so pixels do not depend on the processor.

#include <cstddef>
#include <span>
#include <string>

#include "base/sink.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// Decodes a JPEG file under the contract of decode_image.
Rgba8Image decode_jpeg(std::span<const std::byte> bytes, const std::string& name, Sink& sink);
/// Reads the header of a JPEG file under the contract of read_image_header.
ImageHeader read_jpeg_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
