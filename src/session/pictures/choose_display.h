#pragma once

// How PNG, JPEG and screens show the picture: the tone map and the exposure that are asked for, the light meter's, or
// numbers in place of tones.

#include <optional>

#include "session/photometry.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the lumens that a watt of the scene counts as: those asked for, or by the kind of file.
double efficacy_of(const SceneOptions& options);
/// Returns the exposure of a lens and a film; none if that was not given.
std::optional<PhysicalExposure> physical_exposure(const PictureOptions& options);
/// Returns the numbers that are shown; none if tones are shown. A scale without a range fits the picture. Throws
/// Error(BadInput).
std::optional<FalseColors> false_colors(const PictureOptions& options);
/// Returns whether nothing says the exposure, so that the light meter does.
bool is_metered(const PictureOptions& options);
/// Returns how the present picture is shown. Throws Error(BadInput), and what Session::meter throws.
Display choose_display(const PictureOptions& options, Session& session);

} // namespace pertev
