#include "session/adaptive_exposure.h"

#include "image/auto_exposure.h"
#include "session/meter_exposure.h"

namespace pertev {

float AdaptiveExposure::next(const FrameTones& tones, ToneMap tone_map) {
    const bool scatters = share_that_counts(tones.scattered) >= kFewestThatCount;
    const float goal = auto_exposure_stops(scatters ? tones.scattered : tones.all, tone_map);
    stops_ += kShare * (goal - stops_);
    return stops_;
}

} // namespace pertev
