#pragma once

// Radiance HDR (RGBE): flat, old and new run-length coding, all eight orientations. Called by decode_image.
//
// Source: Ward, "Real Pixels", Graphics Gems II, 1991; the Radiance reference manual, "Picture File Format". A pixel
// is mantissa * 2^(exponent - 136), without Radiance's later half unit, as in other renderers.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "image/color_primaries.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// RGB picture, linear, with the primaries of the file. Values are divided by the header's EXPOSURE and COLORCORR
/// (products of all lines).
Image decode_hdr(std::span<const std::byte> bytes, const std::string& name);
/// The numbers of the header's line PRIMARIES; nothing if there is none, or eight zeros, which Photoshop writes for
/// none.
std::optional<ColorPrimaries> read_hdr_primaries(std::span<const std::byte> bytes, const std::string& name);
/// Reads the header of an HDR file under the contract of read_image_header.
ImageHeader read_hdr_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
