#pragma once

// The samples of each pixel that one call or one machine takes: all of the picture, a range, or one of equal parts.

#include "render/film.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the requested samples: those of `samples`, or of `part`, which may be none if there are more parts than
/// samples; else all. Throws Error(BadInput) for a text that is neither, and for a part that does not exist.
SampleRange sample_range(const PictureOptions& options);

} // namespace pertev
