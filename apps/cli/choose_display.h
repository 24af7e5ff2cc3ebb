#pragma once

// How PNG and JPEG show the picture: the tone map and the exposure that the flags ask for, or the light meter's.

#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// None where no PNG or JPEG is among the outputs. Where the exposure is not given, the meter looks at the scene; a
/// notice then tells the flags that fix what was found. With --json, an object of the exposure. Throws Error.
std::optional<Display> choose_display(const RenderFlags& flags, Session& session, Reporter& reporter);
/// The same for a picture that is shown on a screen.
Display choose_shown_display(const RenderFlags& flags, Session& session, Reporter& reporter);

} // namespace pertev
