// Compiled for AVX-512 (tests/CMakeLists.txt), and empty where the program has no functions of sixteen lanes.

#if defined(PERTEV_HAS_16_LANES)

#include "math/lanes16.h"

namespace pertev::test::lanes {
namespace {

using Floats = Floats16;

} // namespace
} // namespace pertev::test::lanes

#include "tests/support/check_lanes.inl"

namespace pertev::test {

LaneDifferences check_lanes_of_16() { return lanes::check_lanes(); }

} // namespace pertev::test

#endif
