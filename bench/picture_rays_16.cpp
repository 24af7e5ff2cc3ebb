// Compiled for AVX-512 (bench/CMakeLists.txt), and empty where the program has no functions of sixteen lanes.

#if defined(PERTEV_HAS_16_LANES)

#include "bench/picture_rays.h"
#include "math/lanes16.h"

namespace pertev {

void trace_by_avx_512(const HostTrees& trees, const PictureRays& set) { trace_picture_rays<Floats16>(trees, set); }

} // namespace pertev

#endif
