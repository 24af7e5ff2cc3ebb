#pragma once

// The part of a picture that one call or one machine renders: rows of pixels, and a range of the samples of each or one
// of equal parts of them.

#include <utility>

#include "render/film.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the requested samples: those of `samples`, or of `part`, which may be none if there are more parts than
/// samples; else all. Throws Error(BadInput) for a text that is neither, and for a part that does not exist.
SampleRange sample_range(const PictureOptions& options);

/// Returns the requested rows [first, end); (0, 0) for all. Throws Error(BadInput) for another text.
std::pair<uint32_t, uint32_t> row_range(const PictureOptions& options);

} // namespace pertev
