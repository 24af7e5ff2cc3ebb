#pragma once

// Progress of a film's render, for a sink.

#include "base/sink.h"
#include "settings/render_settings.h"

namespace pertev {

/// Returns the progress of an integrator's precomputation.
Progress made_progress(uint32_t done, uint32_t samples, double made_share, double seconds, const RayCounts& rays);

/// Returns the progress of the samples, or of the time if that ends first. `samples` is the number at the end.
Progress progress_of(const RenderSettings& settings, uint32_t done, uint32_t samples, double seconds,
                     double made_seconds, const RayCounts& rays);

} // namespace pertev
