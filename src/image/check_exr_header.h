#pragma once

// Validates the header of an OpenEXR file. The OpenEXR library trusts attribute sizes, tile sizes and the number of
// chunks and allocates accordingly; after this check it cannot be made to allocate more than the file can fill.
//
// Source: "OpenEXR File Layout", openexr.com.

#include <cstddef>
#include <span>
#include <string>

#include "image/image_header.h"

namespace pertev {

/// Returns the size of the first part's display window if every part's header is complete and the file could contain
/// its picture. Throws Error(BadInput) or Error(OverLimit) that starts with `name` and says the fault.
ImageHeader check_exr_header(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
