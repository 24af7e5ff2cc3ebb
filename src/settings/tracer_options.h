#pragma once

// How pictures find what rays meet, by the settings `build`, `structure`, `walk` and their switches. None changes the
// picture. `build` says which tree stands behind all rays; `structure` names one for some or all of them exactly, and
// goes before it. A text is "NAME" for all rays, or "KIND=NAME" for camera, bounce or shadow rays; the last that names
// a ray counts.

#include <optional>

#include "settings/picture_options.h"

namespace pertev {

/// Returns whether a better tree than `build` asks for will do: no `structure` names one.
inline bool may_be_better(const TracerOptions& options) { return options.structures.empty(); }

/// Returns what the options ask for, and the device's default where they say nothing; none if that is its default.
/// Throws Error(BadInput) where pictures cannot be traced so.
std::optional<TracerChoice> tracer_choice(const TracerOptions& options, bool on_cuda);

} // namespace pertev
