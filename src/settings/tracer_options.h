#pragma once

// The tracers of pictures, from the settings `build`, `structure`, `traversal` and their switches. None changes the
// picture. `build` selects the tree for all rays; `structure` names one for some or all of them exactly, and takes
// precedence. A text is "NAME" for all rays, or "KIND=NAME" for camera, bounce or shadow rays; the last one that
// applies to a ray counts.

#include <optional>

#include "settings/picture_options.h"

namespace pertev {

/// Returns whether a better tree than `build` requests is acceptable: no `structure` names one.
inline bool may_be_better(const TracerOptions& options) { return options.structures.empty(); }

/// Returns the requested tracers, with the device's default for whatever is not given; none if that is the default.
/// The texts are valid values of the settings. Throws Error(BadInput) if pictures cannot be traced so.
std::optional<TracerChoice> tracer_choice(const TracerOptions& options, bool on_cuda);

} // namespace pertev
