#pragma once

// A vote among the lanes of a warp that run the same line at this moment. Who they are depends on timing, so a vote may
// decide how much work is done, never what comes out. On the host a warp is one ray.

#include "base/host_device.h"

namespace pertev {

HD inline bool all_lanes(bool mine) {
#if PERTEV_ON_DEVICE
    return __all_sync(__activemask(), mine) != 0;
#else
    return mine;
#endif
}

} // namespace pertev
