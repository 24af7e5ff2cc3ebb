#pragma once

// How PNG and JPEG show the picture: the tone map and the exposure that the flags ask for, or the light meter's.

#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"
#include "image/tone_map.h"

namespace pertev {

struct Display {
    ToneMap tone_map = ToneMap::Agx;
    float exposure_stops = 0;
    bool is_used = false; // a PNG or JPEG is among the outputs
};

/// Renders the meter's small picture where the exposure is not given and some output needs it; a notice then tells the
/// flags that fix what was found. With --json, an object of the exposure. Throws Error.
Display choose_display(const RenderFlags& flags, Queue& queue, const PreparedScene& prepared, const Camera& camera,
                       const RenderSettings& settings, Reporter& reporter);

} // namespace pertev
