#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/render_flags.h"

namespace pertev {

void check_real_time_flags(const RenderFlags& flags) {
    if (!flags.real_time) return;
    const RenderSettings& settings = flags.render;
    refuse(settings.samples != 1,
           fmt::format("--spp {}: a frame of --real-time has one sample per pixel", settings.samples));
    refuse(!makes_frames(settings.integrator),
           fmt::format("--real-time: works with --integrator path, direct, indirect and hybrid, not with {}",
                       integrator_name(settings)));
}

} // namespace pertev
