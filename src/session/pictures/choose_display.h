#pragma once

// How PNG, JPEG and screens show the picture: requested tone map and exposure, the light meter's exposure, or false
// colours.

#include <optional>

#include "base/sink.h"
#include "session/photometry.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the scene's lumens per watt: as requested, or by the kind of file.
double efficacy_of(const SceneOptions& options);
/// Returns the physical exposure; none if it was not given.
std::optional<PhysicalExposure> physical_exposure(const PictureOptions& options);
/// Returns the quantity shown in false colours; none if tones are shown. A scale without a range fits the picture.
/// Throws Error(BadInput).
std::optional<FalseColors> false_colors(const PictureOptions& options);
/// Returns the stops of `exposure`; none for auto. Throws Error(BadInput).
std::optional<float> requested_exposure(const PictureOptions& options);
/// Returns whether the light meter sets the exposure because nothing else does.
bool is_metered(const PictureOptions& options);
/// Returns how the current picture is shown, and says by which exposure, with the settings that fix a metered one.
/// Throws Error(BadInput), and what Session::meter throws.
Display choose_display(const PictureOptions& options, Session& session, Sink& sink);

} // namespace pertev
