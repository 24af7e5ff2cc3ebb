#include "trace/wide/nearest_triangles.h"

#include "math/lanes.h"
#include "trace/wide/nearest_triangles_body.h"

namespace pertev {

const TriangleTests kTestsOf8Rays = {Floats8::kLanes, find_nearest<Floats8>};

const TriangleTests& triangle_tests() {
#if defined(PERTEV_HAS_16_LANES)
    static const TriangleTests& widest = takes_sixteen_lanes() ? kTestsOf16Rays : kTestsOf8Rays;
    return widest;
#else
    return kTestsOf8Rays;
#endif
}

} // namespace pertev
