// Compiled for AVX-512 (src/CMakeLists.txt), and empty where the compiler cannot keep its functions to itself.

#if defined(PERTEV_HAS_16_LANES)

#include "math/lanes16.h"
#include "trace/wide/nearest_triangles_body.h"

namespace pertev {

const TriangleTests kTestsOf16Rays = {Floats16::kLanes, find_nearest<Floats16>};

} // namespace pertev

#endif
