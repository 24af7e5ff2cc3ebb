#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/render_flags.h"

namespace pertev {

void check_real_time_flags(const RenderFlags& flags) {
    if (!flags.real_time) return;
    const RenderSettings& settings = flags.render;
    refuse(settings.samples != 1,
           fmt::format("--spp {}: a frame of --real-time has one sample a pixel", settings.samples));
    refuse(
        !makes_frames(settings.integrator),
        fmt::format("--real-time: frames are reconstructed of the samples of --integrator path, direct, indirect and "
                    "hybrid, not of {}'s",
                    integrator_name(settings)));
}

} // namespace pertev
