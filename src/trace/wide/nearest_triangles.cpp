#include "trace/wide/nearest_triangles.h"

#include "base/processor.h"
#include "math/lanes.h"
#include "trace/wide/nearest_triangles_body.h"

namespace pertev {
namespace {

void find_nearest_of_8(const TriangleList& list, const Ray* rays, int kz, unsigned active, bool any,
                       NearestTriangles& nearest) {
    find_nearest<Floats8>(list, rays, kz, active, any, nearest);
}

} // namespace

const TriangleTests kTestsOf8Rays = {8, find_nearest_of_8};

const TriangleTests& triangle_tests() {
#if defined(PERTEV_HAS_16_LANES)
    static const TriangleTests& widest = has_sixteen_lanes() ? kTestsOf16Rays : kTestsOf8Rays;
    return widest;
#else
    return kTestsOf8Rays;
#endif
}

} // namespace pertev
