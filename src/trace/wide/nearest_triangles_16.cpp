// Compiled for AVX-512 (src/CMakeLists.txt), and empty where the compiler cannot keep its functions to itself.

#if defined(PERTEV_HAS_16_LANES)

#include "math/lanes16.h"
#include "trace/wide/nearest_triangles_body.h"

namespace pertev {
namespace {

void find_nearest_of_16(const TriangleList& list, const Ray* rays, int kz, unsigned active, bool any,
                        NearestTriangles& nearest) {
    find_nearest<Floats16>(list, rays, kz, active, any, nearest);
}

} // namespace

const TriangleTests kTestsOf16Rays = {16, find_nearest_of_16};

} // namespace pertev

#endif
