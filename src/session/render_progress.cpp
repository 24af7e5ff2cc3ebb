#include "session/render_progress.h"

#include <algorithm>

namespace pertev {

Progress made_progress(uint32_t done, uint32_t samples, double made_share, double seconds, const RayCounts& rays) {
    Progress now = {.doing = "before_samples", .share = made_share, .seconds = seconds};
    if (made_share > 0.01) now.seconds_left = seconds * (1 - made_share) / made_share;
    now.samples_done = done, now.samples = samples, now.rays = rays.total();
    now.made_share = made_share, now.made_seconds = seconds;
    return now;
}

Progress progress_of(const RenderSettings& settings, uint32_t done, uint32_t samples, double seconds,
                     double made_seconds, const RayCounts& rays) {
    Progress now = {.doing = "samples", .share = static_cast<double>(done) / samples, .seconds = seconds};
    const double limit = settings.time_limit_s - made_seconds, sampled = seconds - made_seconds;
    if (limit > 0) now.share = std::clamp(sampled / limit, now.share, 1.0);
    if (now.share > 0) now.seconds_left = sampled * (1 - now.share) / now.share;
    now.samples_done = done, now.samples = samples, now.rays = rays.total();
    now.made_seconds = made_seconds;
    return now;
}

} // namespace pertev
