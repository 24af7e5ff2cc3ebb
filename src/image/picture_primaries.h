#pragma once

// What R, G and B of a picture file with float colours mean: the attribute `chromaticities` of OpenEXR ("Technical
// Introduction"), the line PRIMARIES of Radiance HDR. A file without them holds Rec. 709.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "base/messages.h"
#include "image/color_primaries.h"

namespace pertev {

/// The matrix that makes the file's colours Rec. 709. Nothing where they are, as those of PNG and JPEG, or, after a
/// warning that starts with `name`, where its primaries are degenerate. Throws as decode_image does.
std::optional<ColorMatrix> color_matrix_of(std::span<const std::byte> bytes, const std::string& name,
                                           Messages* messages);

} // namespace pertev
