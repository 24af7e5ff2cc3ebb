#include "bench/picture_rays.h"

#include "base/processor.h"

namespace pertev {

void trace_as_pictures(const HostTrees& trees, const PictureRays& set) {
#if defined(PERTEV_HAS_16_LANES)
    if (takes_sixteen_lanes()) return trace_by_avx_512(trees, set);
#endif
    trace_picture_rays<Floats8>(trees, set);
}

} // namespace pertev
