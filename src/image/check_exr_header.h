#pragma once

// Walks the header of an OpenEXR file without trusting one number of it. The OpenEXR library takes attribute sizes,
// tile sizes and the number of chunks at their word and reserves memory for them; after this check it cannot be made
// to reserve more than the file can fill.
//
// Source: "OpenEXR File Layout", openexr.com.

#include <cstddef>
#include <span>
#include <string>

#include "image/image_header.h"

namespace pertev {

/// The size of the first part's display window, when every part's header is whole and its picture could be held by the
/// file. Throws Error(BadInput) or Error(OverLimit) that starts with `name` and says what is wrong.
ImageHeader check_exr_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
