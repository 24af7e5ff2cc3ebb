#pragma once

// Decodes PNG, JPEG, Radiance HDR and OpenEXR from memory, identified by content. Files are untrusted:
// allocations are bounded by the possible contents of the bytes (image/check_image_size.h).

#include <cstddef>
#include <span>
#include <string>
#include <variant>

#include "base/sink.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// Decodes the picture in `bytes`; `name` starts every message. Colour profiles, gamma chunks and Exif orientations
/// are not applied (as glTF requires). Result by source:
///   PNG up to 8 bits, JPEG, WebP Rgba8Image, values as stored (colour: sRGB-encoded); grey is repeated, CMYK converted
///   PNG with 16 bits         Image with the file's 1 to 4 channels in [0, 1], values as stored: still sRGB-encoded if
///                            the picture has colours (recognise_image distinguishes this from the next two)
///   HDR                      Image, RGB, linear; divided by the file's EXPOSURE and COLORCORR
///   EXR                      Image, RGB, RGBA, Y or YA, linear, values as stored (image/picture_primaries.h reads the
///                            primaries); of the display window, 0 where there is no data
/// Throws Error(BadInput) for data that is damaged, truncated or none of these, Error(OverLimit) for more pixels than
/// base/limits.h allows. Damage that leaves every pixel known (a bad checksum in a comment) gives a warning.
std::variant<Rgba8Image, Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                                             Sink& sink = nobody());

/// Returns the size of the picture according to the file's header. Throws Error for an invalid header.
ImageHeader read_image_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
