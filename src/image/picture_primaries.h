#pragma once

// Primaries of a picture file with float colours: the attribute `chromaticities` of OpenEXR ("Technical
// Introduction"), the line PRIMARIES of Radiance HDR. A file without them has Rec. 709.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "base/sink.h"
#include "image/color_primaries.h"

namespace pertev {

/// The matrix from the file's colours to Rec. 709. Nothing if they are Rec. 709, as in PNG and JPEG, or if its
/// primaries are degenerate, which gives a warning that starts with `name`. Throws as decode_image does.
std::optional<ColorMatrix> color_matrix_of(std::span<const std::byte> bytes, const std::string& name, Sink& sink);

} // namespace pertev
