#pragma once

// Reports how PNG, JPEG and screens show the picture.

#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"

namespace pertev {

/// Returns choose_display(). A notice lists flags that fix the metered exposure; with --json there is an object with
/// the exposure. Throws Error.
Display choose_and_report_display(const RenderFlags& flags, Session& session, Reporter& reporter);

} // namespace pertev
