#pragma once

// Decodes PNG, JPEG, Radiance HDR and OpenEXR from memory, by content and not by name. Meant for files of strangers:
// memory asked for is bounded by what the bytes can hold (image/check_image_size.h).

#include <cstddef>
#include <span>
#include <string>
#include <variant>

#include "base/messages.h"
#include "image/image.h"
#include "image/image_header.h"

namespace pertev {

/// The picture in `bytes`; `name` starts every message. Colour profiles and gamma chunks are not applied, nor is an
/// Exif orientation (as glTF asks). Result by source:
///   PNG up to 8 bits, JPEG   Rgba8Image, values as stored (colour: sRGB-encoded); grey is repeated, CMYK converted
///   PNG with 16 bits         Image of the file's 1 to 4 channels in [0, 1], values as stored: still sRGB-encoded
///                            where the picture is colour (recognise_image tells this case from the next two)
///   HDR                      Image, RGB, linear; divided by the file's EXPOSURE and COLORCORR
///   EXR                      Image, RGB, RGBA, Y or YA, linear, values as stored (image/picture_primaries.h tells of
///   which
///                            primaries); of the display window, 0 where there is no data
/// Throws Error(BadInput) for what is damaged, cut short or none of these, Error(OverLimit) for more pixels than
/// base/limits.h allows. Damage that leaves every pixel known (a bad checksum in a comment) is a warning.
std::variant<Rgba8Image, Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                                             Messages* messages = nullptr);

/// The size of that picture, off the file's header. Throws likewise for what the header shows to be wrong.
ImageHeader read_image_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
