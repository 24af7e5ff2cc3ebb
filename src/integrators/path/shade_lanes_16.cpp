// Compiled for AVX-512 (src/CMakeLists.txt), and empty where the compiler cannot keep its functions to itself.

#if defined(PERTEV_HAS_16_LANES)

#include "math/lanes16.h"

namespace pertev {
namespace {

using Floats = Floats16;

} // namespace
} // namespace pertev

#include "integrators/path/shade_lanes.inl"

namespace pertev {

const VertexShading kShadingOf16 = kShading;

} // namespace pertev

#endif
