#include "denoise/oidn/oidn_frames.h"

#include "base/error.h"
#include "denoise/oidn/oidn_stages.h"
#include "device/launch.h"

namespace pertev {

const Float4* OidnFrames::apply(const Float4* shown, const NoisyFrame& frame) {
    PERTEV_CHECK(fits(frame));
    const uint32_t pixels = width_ * height_;
    launch(queue_, "read_shown_frame", pixels,
           ReadShownFrame{shown, frame.view(), filter_.color(), filter_.albedo(), filter_.normal()});
    filter_.run();
    launch(queue_, "show_color", pixels, ShowColor{filter_.color()});
    return filter_.color();
}

} // namespace pertev
