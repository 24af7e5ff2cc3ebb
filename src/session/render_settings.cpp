#include "session/render_settings.h"

namespace pertev {

bool same_picture(const RenderSettings& a, const RenderSettings& b) {
    return a.width == b.width && a.height == b.height && a.filter == b.filter &&
           filter_radius_of(a) == filter_radius_of(b) && a.aovs == b.aovs && a.transparent == b.transparent &&
           same_light(a, b);
}

} // namespace pertev
