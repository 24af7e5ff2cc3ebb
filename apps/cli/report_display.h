#pragma once

// Says how PNG, JPEG and screens show the picture.

#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"

namespace pertev {

/// Returns choose_display(). A notice tells which flags fix what the meter has found; with --json there is an object of
/// the exposure. Throws Error.
Display choose_and_report_display(const RenderFlags& flags, Session& session, Reporter& reporter);

} // namespace pertev
