#pragma once

// What R, G and B of an OpenEXR file mean: its attribute `chromaticities` (OpenEXR, "Technical Introduction"). A file
// without it holds Rec. 709.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "base/messages.h"
#include "image/color_primaries.h"

namespace pertev {

/// The matrix that makes the file's colours Rec. 709. Nothing where they are, or, after a warning that starts with
/// `name`, where its chromaticities are degenerate. Throws as decode_image does.
std::optional<ColorMatrix> exr_color_matrix(std::span<const std::byte> bytes, const std::string& name,
                                            Messages* messages);

} // namespace pertev
