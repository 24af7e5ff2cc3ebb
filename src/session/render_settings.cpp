#include "session/render_settings.h"

namespace pertev {

TracerChoice tracers_of(const RenderSettings& settings, bool on_cuda) {
    return settings.tracers.value_or(default_tracers(on_cuda));
}

PrepareOptions prepare_options(const RenderSettings& settings, bool on_cuda) {
    PrepareOptions options;
    options.tracers = tracers_of(settings, on_cuda);
    return options;
}

void set_default_size(RenderSettings& settings, const Camera* own) {
    settings.width = 1280, settings.height = 720;
    if (own == nullptr || !(own->aspect > 0)) return;
    settings.width = static_cast<uint32_t>(to_int(720 * own->aspect + 0.5f, 1, 8192));
}

bool same_picture(const RenderSettings& a, const RenderSettings& b) {
    return a.width == b.width && a.height == b.height && a.filter == b.filter &&
           filter_radius_of(a) == filter_radius_of(b) && a.aovs == b.aovs && a.transparent == b.transparent &&
           a.denoise == b.denoise && same_light(a, b);
}

} // namespace pertev
